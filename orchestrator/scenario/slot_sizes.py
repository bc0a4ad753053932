"""The shortest slots that standards ask a system to use: numbers as data, in ``orchestrator/limits/slots``."""

from orchestrator.scenario.requirements import LIMITS
from orchestrator.text.quantities import measured
from orchestrator.text.yaml_file import read_mapping


def shipped_slot_sizes(standard: str) -> dict[str, float]:
    """Return the numbers of a standard in SI, by the names that ``SlotSizes`` of the assist has for them."""
    file = LIMITS / "slots" / f"{standard}.yaml"
    return {name: measured(value, file=file, key=name)[0] for name, value in read_mapping(file).items()}
