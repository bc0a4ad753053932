"""FMUs that are not ours, made with stock PythonFMU as its users make them: no units, no variability, few variables."""

import re
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path

from pythonfmu.builder import FmuBuilder

CONTROLLER = '''
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Integer, Real


class Theirs(Fmi2Slave):
    """Reverses on two arcs."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.wheel, self.measured_speed = 5.0, 0.0
        self.{request}, self.steering_active, self.prompt, self.phase = 0.0, True, 3, 2
        self.register_variable(Real("wheel", causality=Fmi2Causality.parameter))
        self.register_variable(Real("measured_speed", causality=Fmi2Causality.input))
        self.register_variable(Real("{request}", causality=Fmi2Causality.output))
        self.register_variable(Boolean("steering_active", causality=Fmi2Causality.output))
        self.register_variable(Integer("prompt", causality=Fmi2Causality.output))
        {phase}

    def do_step(self, t, dt):
        {step}
        self.{request} = -self.wheel if t < 3.0 else self.wheel
        if t >= 6.0:
            self.prompt, self.phase = 1, 9
        return True
'''
COSIMULATION = re.compile("<CoSimulation[^>]*/>")
MODEL_EXCHANGE = '<ModelExchange modelIdentifier="Theirs"/>'
PHASE = 'self.register_variable(Integer("phase", causality=Fmi2Causality.output))'


def controller(
    folder: Path, *, request: str = "steering_wheel_request", step: str = "pass", phase: bool = True
) -> Path:
    """Return a controller made with PythonFMU; ``step`` is a statement of its do_step."""
    script = folder / "theirs.py"
    script.write_text(CONTROLLER.format(request=request, step=step, phase=PHASE if phase else "pass"))
    return Path(FmuBuilder.build_FMU(script, dest=folder))


def changed(path: Path, to: Path, change: Callable[[str], str]) -> Path:
    """Return a copy of an FMU at ``to`` whose modelDescription.xml went through ``change``."""
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(to, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            target.writestr(name, change(data.decode()) if name == "modelDescription.xml" else data)
    return to


def broken(path: Path, folder: Path) -> dict[str, tuple[Path, str]]:
    """Return name -> (FMU that cannot be run, what is said of it), made from the good one at ``path``."""
    text, empty, elsewhere = folder / "text.fmu", folder / "empty.fmu", folder / "elsewhere.fmu"
    text.write_text("no zip")
    with zipfile.ZipFile(empty, "w") as archive:
        archive.writestr("readme.txt", "")
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(elsewhere, "w") as target:
        for name in source.namelist():
            if not name.startswith("binaries"):
                target.writestr(name, source.read(name))
    outside = Path(shutil.copy(path, folder / "outside.fmu"))
    with zipfile.ZipFile(outside, "a") as archive:
        archive.writestr("/etc/theirs", "")
    xml = changed(path, folder / "xml.fmu", lambda found: found[: len(found) // 2])
    start = changed(path, folder / "start.fmu", lambda found: found.replace('<Real start="5', '<Real start="five'))
    exchange = changed(path, folder / "exchange.fmu", lambda found: COSIMULATION.sub(MODEL_EXCHANGE, found))
    other = changed(path, folder / "other.fmu", lambda found: found.replace("<Integer/>", "<Real/>"))
    return {
        "no zip": (text, "is not an FMU"),
        "no description": (empty, "is not an FMU"),
        "cut description": (xml, "is not an FMU"),
        "start value": (start, "is no start value of type Real"),
        "model exchange": (exchange, "is an FMU for Model Exchange only"),
        "no binary": (elsewhere, "has no binary for this machine"),
        "path outside": (outside, "would be written outside its folder"),
        "other type": (other, "output of controller is float, input of vehicle is int"),
    }
