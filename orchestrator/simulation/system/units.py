"""From one unit to another: by what the FMUs define, else by what is known of units."""

from collections.abc import Mapping

from fmus.contents.units import BASE, unit
from orchestrator.inputs.text.quantities import FACTORS, unit_symbol
from orchestrator.simulation.cosim.fmu_instance import Scale

SAME = (1.0, 0.0)


class UnfitUnitsError(ValueError):
    """Two units that are not of the same quantity."""


def scale_of(name: str, defined: Mapping[str, Scale]) -> Scale | None:
    """Return a unit in SI base units: as its FMU defines it, else as it is commonly meant; None if nobody knows."""
    if name in defined:
        return defined[name]
    symbol = unit_symbol(name)
    target, factor = FACTORS.get(symbol, (symbol, 1.0))
    try:
        found = unit(target.replace(" ", ""))
    except ValueError:
        return None
    return Scale(factor * found.factor, 0.0, tuple(found.exponents.get(base, 0) for base in BASE))


def conversion(given: str, taken: str, from_: Mapping[str, Scale], into: Mapping[str, Scale]) -> tuple[float, float]:
    """Return (factor, offset) that bring a number in the unit ``given`` into ``taken``.

    Raises ``UnfitUnitsError`` if they are not of the same quantity, or unknown and not the same.
    """
    if given == taken:
        return SAME
    source, target = scale_of(given, from_), scale_of(taken, into)
    if source is None or target is None or source.exponents != target.exponents:
        raise UnfitUnitsError(f"{given} cannot become {taken}")
    if (source.factor, source.offset) == (target.factor, target.offset):
        return SAME
    return source.factor / target.factor, (source.offset - target.offset) / target.factor
