"""The shipped cars: usable, their sensors on their outline, CommonRoad's numbers in the files of its cars."""

from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
import yaml

from modelkit.car import Car
from modelkit.variables import flatten, variables, with_values
from orchestrator.inputs.scenario.files import car_names
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from tests.vehicle.cars import CARS, double_track_car, single_track_car
from vehicle_fmu.interface import Body, VehicleParams
from vehicle_fmu.usable import is_usable


def loaded(name: str, tmp_path: Path) -> Any:
    """Return the parameters of a car as a scenario gets them."""
    file = tmp_path / "scenario.yaml"
    content = {"name": "any", "car": name, "target": {"x": 0, "y": 0, "heading": 0}}
    file.write_text(yaml.safe_dump(content))
    return with_values(VehicleParams, load_scenario(str(file)).vehicle)


@pytest.mark.parametrize("name", car_names())
def test_every_car_is_usable_on_every_body(name: str, tmp_path: Path) -> None:
    car = loaded(name, tmp_path)
    for body in Body:
        assert is_usable(car._replace(body=int(body)))


@pytest.mark.parametrize("name", car_names())
def test_sensors_sit_on_the_outline(name: str, tmp_path: Path) -> None:
    car = loaded(name, tmp_path)
    built = car.car
    front, rear, side = built.wheelbase + built.front_overhang, -built.rear_overhang, 0.5 * built.width
    for mount in built.ultrasonic.mounts:
        assert rear - 0.01 <= mount.x <= front + 0.01
        assert abs(mount.y) <= side + 0.01
        gap = min(front - mount.x, mount.x - rear, side - abs(mount.y))
        assert gap < 0.15, "near the skin of the car"


@pytest.mark.parametrize("number", [1, 2, 3])
def test_commonroads_cars_have_commonroads_numbers(number: int, tmp_path: Path) -> None:
    car = loaded(f"commonroad{number}", tmp_path)
    stance, chassis, double = double_track_car(CARS[number - 1])
    _, _, single = single_track_car(CARS[number - 1])
    assert (car.car.wheelbase, car.car.cg_to_rear) == pytest.approx(stance, rel=1e-6)
    chosen = {"rolling_resistance", "drag_x", "drag_y"}
    for field in set(chassis._fields) - chosen:
        assert getattr(car.chassis, field) == pytest.approx(getattr(chassis, field), rel=1e-5)
    for field in ("stiffness_front", "stiffness_rear", "load_height"):
        assert getattr(car.single_track, field) == pytest.approx(getattr(single, field), rel=1e-5)
    ours = dict(zip((v.name for v in variables(type(double))), flatten(car.double_track), strict=True))
    theirs = dict(zip((v.name for v in variables(type(double))), flatten(double), strict=True))
    for name in set(theirs) - {"ackermann"}:
        assert ours[name] == pytest.approx(theirs[name], rel=1e-5, abs=1e-9), name


@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_parameter_file_of_commonroad_is_a_car(number: int, tmp_path: Path) -> None:
    file = Path(str(files("vehiclemodels"))) / "parameters" / f"parameters_vehicle{number}.yaml"
    theirs = flatten(loaded(str(file), tmp_path)._replace(car=Car()))
    ours = flatten(loaded(f"commonroad{number}", tmp_path)._replace(car=Car()))
    assert theirs == pytest.approx(ours, rel=2e-5)
    built, shipped = loaded(str(file), tmp_path).car, loaded(f"commonroad{number}", tmp_path).car
    assert flatten(built._replace(ultrasonic=shipped.ultrasonic)) == pytest.approx(flatten(shipped), abs=1e-4)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("m_s:", "m_x:"), "m_x: unknown"),
        (("\nI_z:", "\n# I_z:"), "I_z: is missing"),
        (("min: -0.91", "min: -0.5"), "steering: expected max above 0"),
        (("w: 1.674", "w: wide"), "w: 'wide' is not a number"),
        (("# masses", "trailer: {l: 3}"), "trailer: unknown"),
    ],
)
def test_a_parameter_file_that_cannot_be_a_car_is_refused(change: tuple[str, str], said: str, tmp_path: Path) -> None:
    file = Path(str(files("vehiclemodels"))) / "parameters" / "parameters_vehicle1.yaml"
    text = file.read_text(encoding="utf-8")
    assert change[0] in text
    (tmp_path / "car.yaml").write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(BadInput) as error:
        loaded("car.yaml", tmp_path)
    assert said in str(error.value)
