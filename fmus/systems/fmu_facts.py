"""What connecting an FMU takes to know of its variables, from its modelDescription.xml alone: FMI 2.0 and 3.0."""

import io
import zipfile
from collections.abc import Iterator, Mapping
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
REALS = ("Real", "Float64", "Float32")
MAX_DESCRIPTION = 1 << 26


class UnitScale(NamedTuple):
    """A unit in SI base units: ``value * factor + offset``."""

    factor: float
    offset: float
    exponents: tuple[int, ...]
    """Of kg, m, s, A, K, mol, cd, rad."""


class FmuVariable(NamedTuple):
    """One variable as its FMU declares it."""

    causality: str
    type: str
    """Of FMI: ``Real``, ``Float64``, ``String``..."""
    unit: str | None
    """None: not declared."""
    is_array: bool
    scales: Mapping[str, UnitScale]
    """Unit that the FMU defines -> what it is."""

    @property
    def is_real(self) -> bool:
        """Whether it can have a unit."""
        return self.type in REALS


def variables_in(fmu: bytes) -> dict[str, FmuVariable]:
    """Return name -> variable of an FMU. Raises ``ValueError``, ``KeyError`` or ``BadZipFile`` if it is none."""
    with zipfile.ZipFile(io.BytesIO(fmu)) as archive:
        entry = archive.getinfo("modelDescription.xml")
        if entry.file_size > MAX_DESCRIPTION:
            raise ValueError("its modelDescription.xml is too large")
        try:
            root = ElementTree.fromstring(archive.read(entry))
        except (ElementTree.ParseError, LookupError) as error:
            raise ValueError(f"its modelDescription.xml: {error}") from None
    units = {item.get("name", ""): scale_in(item) for item in root.iter("Unit")}
    scales = {name: scale for name, scale in units.items() if scale is not None}
    types = {item.get("name", ""): item for definitions in root.iter("TypeDefinitions") for item in definitions}
    return dict(_variables(root, types, scales))


def _variables(
    root: Element, types: Mapping[str, Element], scales: Mapping[str, UnitScale]
) -> Iterator[tuple[str, FmuVariable]]:
    for item in root.iter("ModelVariables"):
        for variable in item:
            inner = next((part for part in variable if part.tag != "Annotations"), None)
            typed = inner if variable.tag == "ScalarVariable" and inner is not None else variable
            unit = typed.get("unit") or _unit_of_type(types.get(typed.get("declaredType", "")))
            unit = "1" if unit is not None and unit.strip() == "-" else unit
            causality = variable.get("causality") or "local"
            is_array = any(part.tag == "Dimension" for part in variable)
            yield variable.get("name", ""), FmuVariable(causality, typed.tag, unit or None, is_array, scales)


def _unit_of_type(definition: Element | None) -> str | None:
    """Return the unit of a type: of FMI 3.0 on itself, of FMI 2.0 on what is in it."""
    if definition is None:
        return None
    return definition.get("unit") or next((item.get("unit") for item in definition if item.get("unit")), None)


def scale_in(unit: Element) -> UnitScale | None:
    """Return what a unit is by its ``BaseUnit``; None if that is missing."""
    base = next((item for item in unit if item.tag.rpartition("}")[2] == "BaseUnit"), None)
    if base is None:
        return None
    exponents = tuple(int(base.get(name) or 0) for name in BASE)
    return UnitScale(float(base.get("factor") or 1.0), float(base.get("offset") or 0.0), exponents)
