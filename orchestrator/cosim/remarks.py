"""What should be known of a system before it runs: inputs that nothing feeds, units not said, no verdict possible."""

from collections.abc import Sequence

from orchestrator.cosim.slave import Slave
from orchestrator.scenario.end_condition import EndCondition
from orchestrator.text.errors import suggestion

NEEDED = {
    "controller": {
        "shifts": "limits on the number of shifts are not judged",
    },
    "vehicle": {
        "pose.x": "where the car ends is not judged",
        "pose.y": "where the car ends is not judged",
        "pose.heading": "how the car ends is not judged",
        "speed": "that the car stands ends no run, and limits on speed are not judged",
    },
}
"""Slave -> output that a verdict needs -> what is lost without it."""
SPARE = "person."
"""Inputs of this group need nothing to feed them: their start values mean that nobody is there."""


def remarks(slaves: Sequence[Slave], ending: EndCondition) -> list[str]:
    """Return one sentence for each thing that is allowed but hardly meant in a run that ends so."""
    return [text for slave in slaves for text in (*_units(slave), *_unfed(slave, slaves), *_missing(slave, ending))]


def _units(slave: Slave) -> list[str]:
    names = [name for ports in (slave.inputs, slave.outputs) for name in ports.names if name in ports.unsaid]
    return (
        [f"{slave.name} says no unit of {', '.join(names)}: taken in SI, as the other side has them"] if names else []
    )


def _unfed(slave: Slave, slaves: Sequence[Slave]) -> list[str]:
    others = [other for other in slaves if other is not slave]
    heard = {name for other in others for name in other.outputs.names}
    taken = {name for other in slaves for name in other.inputs.names}
    spare = [f"{other.name}.{name}" for other in others for name in other.outputs.names if name not in taken]
    found, plain = [], []
    for name in slave.inputs.names:
        if name in heard or name.startswith(SPARE):
            continue
        meant = suggestion(name, [full.partition(".")[2] for full in spare])
        if meant:
            found.append(f"nothing feeds {slave.name}.{name}{meant}")
        else:
            plain.append(name)
    if plain:
        found.append(f"nothing feeds {', '.join(plain)} of {slave.name}: they keep their start values")
    return found


def _missing(slave: Slave, ending: EndCondition) -> list[str]:
    owner, _, mode = ending.signal.partition(".")
    says = f"{ending.text(ending.done[0])} of it says that the task is done and, once the car stands, ends the run"
    needed = ({mode: says} if slave.name == owner else {}) | NEEDED.get(slave.name, {})
    return [
        f"{slave.name} has no output {name}: {loss}" for name, loss in needed.items() if name not in slave.outputs.index
    ]
