"""A tunable parameter may change between two steps: it acts from the next one on, alike in every kind of FMU."""

import random
from functools import cache
from typing import Any

import pytest
import toy_model

from controller_fmu import MODEL as CONTROLLER
from controller_fmu.guo2015.phases import GuoPhase
from fmus.contents.variables import fmi_variables, limits
from modelkit.connections import connections, part_of
from modelkit.model import Model
from modelkit.variables import constructor, flatten, variables, with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from tests.fmi.host import DISCARD, ERROR, OK, Host, random_inputs
from tests.fmi.test_python_fmu import bits
from vehicle_fmu import MODEL as VEHICLE

MODELS: dict[str, Model] = {"vehicle": VEHICLE, "controller": CONTROLLER}
SCENARIOS = ("guo2015-case4", "guo2015-case1", "zhang2022-double-track", "hsic", "preview", "adaptive")
EACH_CHANGE = ("guo2015-case4", "zhang2022-double-track")
"""Scenarios that each change looks at; ``make release`` looks at all."""
BY_COST = [pytest.param(name, marks=() if name in EACH_CHANGE else pytest.mark.release) for name in SCENARIOS]
FIRST_ECHO = ("ultrasonic.noise", "ultrasonic.dropout")
STEP_NS = 10_000_000
step_vehicle, step_controller = VEHICLE.stepper(None), CONTROLLER.stepper(None)


def receiver(number: Any) -> Any:
    """Return the function from the outputs of the other model to the inputs of this one."""
    names = list(MODELS)
    wires = [wire for wire in connections([part_of(name, MODELS[name]) for name in names]) if wire.target == number]
    target = MODELS[names[number]]
    start, build = flatten(target.inputs()), constructor(target.inputs)

    def receive(outputs: Any) -> Any:
        given, values = flatten(outputs), list(start)
        for wire in wires:
            values[wire.input] = given[wire.output]
        return build(values)

    return receive


TO_VEHICLE, TO_CONTROLLER = receiver(0), receiver(1)


def tunables(model: Any) -> Any:
    return [item for item in fmi_variables(model) if item.variability == "tunable"]


def constants(scenario: Any) -> Any:
    return {name: with_values(model.params, dict(getattr(scenario, name))) for name, model in MODELS.items()}


@cache
def underway(name: Any) -> Any:
    """Return parameters, states and inputs of a scenario three seconds after the car has begun its path."""
    params = constants(load_scenario(name, []))
    vehicle, reported = VEHICLE.initialize(params["vehicle"])
    controller, asked = CONTROLLER.initialize(params["controller"])
    left = 300
    while left:
        to_vehicle, to_controller = TO_VEHICLE(asked), TO_CONTROLLER(reported)
        vehicle, reported = step_vehicle(vehicle, to_vehicle, params["vehicle"], STEP_NS)
        controller, asked = step_controller(controller, to_controller, params["controller"], STEP_NS)
        assert asked.phase != GuoPhase.FAILED
        left -= asked.phase in (GuoPhase.PATH_TRACKING, GuoPhase.TO_Q2, GuoPhase.TO_Q1) or asked.prompt == 2
    return params, {"vehicle": vehicle, "controller": controller}, (reported, asked)


def drive(name: Any, changed: Any, steps: Any) -> Any:
    """Return all outputs of ``steps`` further steps of both, with other parameters."""
    _, states, (reported, asked) = underway(name)
    vehicle, controller = states["vehicle"], states["controller"]
    rows = []
    for _ in range(steps):
        to_vehicle, to_controller = TO_VEHICLE(asked), TO_CONTROLLER(reported)
        vehicle, reported = step_vehicle(vehicle, to_vehicle, changed["vehicle"], STEP_NS)
        controller, asked = step_controller(controller, to_controller, changed["controller"], STEP_NS)
        rows.append(flatten(reported) + flatten(asked))
    return rows


@cache
def unchanged(name: Any) -> Any:
    """Return the outputs of 150 further steps with the parameters of the scenario."""
    return drive(name, underway(name)[0], 150)


def test_gains_and_thresholds_are_tunable_geometry_is_not() -> None:
    names = {item.name for model in MODELS.values() for item in tunables(model)}
    assert len(names) > 100
    for group in (
        "threshold.",
        "guo2015.threshold.",
        "guo2015.prompting.",
        "limit.",
        "hsic.gain.",
        "zhang2022.pid.",
    ):
        whole = [item.name for item in fmi_variables(CONTROLLER) if item.name.startswith(group)]
        assert whole
        assert set(whole) <= names
    kept = (
        "target",
        "scene",
        "start",
        "chassis",
        "double_track",
        "car.wheelbase",
        "car.ultrasonic",
        "hsic.slot",
    )
    assert not [name for name in names if name.startswith(kept)]


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
@pytest.mark.parametrize("name", BY_COST)
def test_the_memory_at_the_start_is_the_same_whatever_a_tunable_is(model: Any, name: Any) -> None:
    """So a value set before the first step and one set before initialization do the same, but for the first echo."""
    params = constants(load_scenario(name, []))[next(key for key, item in MODELS.items() if item is model)]
    expected, _ = model.initialize(params)
    for item in tunables(model):
        for value in () if item.name in FIRST_ECHO else others(item):
            state, _ = model.initialize(with_values(model.params, {item.name: value}, params))
            assert state == expected, item.name


def others(item: Any) -> Any:
    if item.kind is bool:
        return [True, False]
    return [item.kind(end) for end in limits(item)]


@pytest.mark.parametrize("name", BY_COST)
def test_no_tunable_at_an_end_of_its_range_harms_a_run(name: Any) -> None:
    params, states, (reported, asked) = underway(name)
    given = {"vehicle": TO_VEHICLE(asked), "controller": TO_CONTROLLER(reported)}
    for key, model in MODELS.items():
        for item in tunables(model):
            for value in others(item):
                changed = with_values(model.params, {item.name: value}, params[key])
                state = states[key]
                for _ in range(3):
                    state, outputs = model.stepper(None)(state, given[key], changed, STEP_NS)
                assert all(number - number == 0 for number in flatten(outputs)), item.name


@pytest.mark.parametrize("name", BY_COST)
def test_no_set_of_tunables_within_their_ranges_harms_a_run(name: Any) -> None:
    params = underway(name)[0]
    draw = random.Random(name)
    for _ in range(20):
        changed = {
            key: with_values(model.params, {item.name: drawn(draw, item) for item in tunables(model)}, params[key])
            for key, model in MODELS.items()
        }
        rows = drive(name, changed, 20)
        assert all(number - number == 0 for row in rows for number in row)


def drawn(draw: Any, item: Any) -> Any:
    if item.kind is bool:
        return draw.random() < 0.5
    low, high = limits(item)
    assert low is not None
    assert high is not None
    return item.kind(draw.choice((low, high, low + draw.random() * (high - low))))


@pytest.mark.parametrize(
    ("name", "owner", "parameter", "value"),
    [
        ("guo2015-case1", "controller", "guo2015.k1", 20.0),
        ("guo2015-case1", "controller", "guo2015.prompting.speed_limit", 0.2),
        ("guo2015-case4", "controller", "guo2015.threshold.leave_lateral", 0.0),
        ("guo2015-case1", "controller", "limit.duration", 1.0),
        ("zhang2022-double-track", "controller", "zhang2022.mpc.lateral", 1e5),
        ("zhang2022-double-track", "controller", "zhang2022.pid.proportional", 100.0),
        ("zhang2022-double-track", "controller", "zhang2022.speed", 0.3),
        ("hsic", "controller", "hsic.gain.max_speed", 0.2),
        ("preview", "controller", "preview.set_speed", 3.0),
        ("preview", "controller", "preview.lateral_gain", 10.0),
        ("guo2015-case4", "vehicle", "car.steering.rate_limit", 0.01),
        ("guo2015-case1", "vehicle", "driver.speed_error", 0.5),
        ("guo2015-case1", "vehicle", "driver.takeover_time", 0.0),
        ("zhang2022-double-track", "vehicle", "drive.drive_lag", 2.0),
        ("zhang2022-double-track", "vehicle", "road.grip[1]", 0.02),
        ("adaptive", "vehicle", "ultrasonic.noise", 0.5),
    ],
)
def test_a_changed_tunable_acts(name: str, owner: str, parameter: str, value: float) -> None:
    params = underway(name)[0]
    changed = params | {owner: with_values(MODELS[owner].params, {parameter: value}, params[owner])}
    assert parameter in {item.name for item in tunables(MODELS[owner])}
    assert drive(name, changed, 150) != unchanged(name)


# In the FMUs


@pytest.fixture(params=["python", "native"])
def fmus(request: pytest.FixtureRequest) -> Any:
    return request.getfixturevalue(f"{request.param}_fmus")


def in_process(model: Any, inputs: Any, changes: Any) -> Any:
    """Return the outputs after every step; ``changes``: step -> parameters changed before it."""
    params = model.params()
    make = constructor(model.inputs)
    names = [item.name for item in variables(model.inputs)]
    state, _ = model.initialize(params)
    rows = []
    for number, values in enumerate(inputs):
        params = with_values(model.params, changes.get(number, {}), params)
        dt_ns = round((number * 0.01 + 0.01) * 1e9) - round(number * 0.01 * 1e9)
        state, outputs = model.stepper(None)(state, make([values[name] for name in names]), params, dt_ns)
        rows.append(flatten(outputs))
    return rows


def test_a_change_in_a_run_gives_the_models_own_bits(fmus: Any, model: Any) -> None:
    inputs = random_inputs(fmi_variables(model), 11, 40)
    draw = random.Random(model.name)
    changes = {step: {item.name: settable(draw, item) for item in tunables(model)} for step in (10, 25)}
    expected = in_process(model, inputs, changes)
    with Host(fmus[model.name]) as host:
        host.initialize()
        for number, values in enumerate(inputs):
            host.set({**changes.get(number, {}), **values})
            assert host.step(number * 0.01, 0.01) == OK
            assert bits(host.outputs()) == bits(expected[number])
        assert host.log == []
        name = tunables(model)[0].name
        assert host.get([name]) == [changes[25][name]]


def settable(draw: Any, item: Any) -> Any:
    """Return a value within the range, not far from the one at the start."""
    if item.kind is bool:
        return draw.random() < 0.5
    low, high = (end if end is not None else sign * 10.0 for end, sign in zip(limits(item), (-1, 1), strict=True))
    return item.kind(min(max(item.start * draw.uniform(0.5, 1.5) + draw.uniform(0, 0.1), low), high))


def test_a_changed_tunable_is_part_of_the_saved_state(fmus: Any) -> None:
    with Host(fmus["Toy"]) as host:
        host.initialize()
        host.set({"stiffness": 7.0, "noisy": False})
        assert host.step(0.0, 0.01) == OK
        state = host.fmu.getFMUstate()
        assert host.step(0.01, 0.01) == OK
        expected = bits(host.outputs())
        host.set({"stiffness": 400.0, "noisy": True})
        host.fmu.setFMUstate(state)
        host.fmu.freeFMUstate(state)
        assert host.get(["stiffness", "noisy"]) == [7.0, False]
        assert host.step(0.01, 0.01) == OK
        assert bits(host.outputs()) == expected


@pytest.mark.parametrize(("name", "value"), [("mass", 3.0), ("start[1].position", 0.2), ("seed", 3)])
def test_a_fixed_parameter_is_refused_between_steps(fmus: Any, name: str, value: float) -> None:
    with Host(fmus["Toy"]) as host:
        host.initialize()
        before = host.get([name])
        assert refuses(host, {name: value})
        assert host.get([name]) == before


@pytest.mark.parametrize("value", [-1.0, 1.1e4, float("nan"), float("inf")])
@pytest.mark.parametrize("when", ["at the start", "between steps"])
def test_a_value_out_of_range_is_refused(fmus: Any, value: Any, when: str) -> None:
    with Host(fmus["Toy"]) as host:
        if when == "between steps":
            host.initialize()
        else:
            host.fmu.setupExperiment()
        assert refuses(host, {"stiffness": value})
        if when == "at the start":
            host.fmu.enterInitializationMode()
        assert host.get(["stiffness"]) == [toy_model.MODEL.params().stiffness]


def refuses(host: Any, values: Any) -> Any:
    """Return whether a set is refused: at once, or, as PythonFMU can do no better, by the next step."""
    try:
        host.set(values)
    except Exception:
        return host.log[-1][0] == ERROR
    return host.log[-1][0] == ERROR and host.step(0.0, 0.01) == DISCARD
