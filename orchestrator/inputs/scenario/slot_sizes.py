"""The shortest slots that standards ask a system to use, as data: ``orchestrator/library/requirements/slots``."""

from orchestrator.inputs.scenario.requirements import REQUIREMENT_SETS
from orchestrator.inputs.text.quantities import parse_quantity
from orchestrator.inputs.text.yaml_file import read_mapping


def library_slot_sizes(standard: str) -> dict[str, float]:
    """Return the numbers of a standard in SI, by the names that ``SlotSizes`` of the assist has for them."""
    file = REQUIREMENT_SETS / "slots" / f"{standard}.yaml"
    return {name: parse_quantity(value, file=file, key=name)[0] for name, value in read_mapping(file).items()}
