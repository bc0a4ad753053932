"""Whether a car stands where the source's construction leads into the slot: inside the start range."""

from functools import lru_cache
from typing import Any

from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Kind, Site, Slot, site_of
from controller_fmu.apa.ways.candidates import SHARES, SWING_ANGLES, SWING_WAYS, into_perpendicular, swing
from controller_fmu.apa.ways.exit import VARIANTS, Exit, exit_of
from controller_fmu.apa.ways.fit import ATTEMPTS, margins_of
from controller_fmu.apa.ways.start_range import leads_in
from controller_fmu.common.slot_frame import to_slot
from controller_fmu.registry import ControllerParams
from modelkit.variables import with_values
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.models import MODELS


def is_inside(start: Pose, slot: Slot, controller: dict[str, Any]) -> bool:
    """Return whether a car at ``start`` (world) is inside the start range of ``slot``.

    Parallel: one reverse leads to one of the poses from which the way in is known, Px_min to Px_max of
    the source. Perpendicular: S-A-B-C leads in, or its reverse alone. True pose, true slot, the planner's margins.
    """
    params: ControllerParams = with_values(MODELS["controller"].params, controller)
    if slot.kind == Kind.PARALLEL:
        return any(
            leads_in(to_slot(start, site.frame), way_in, site, car)
            for site, car, ways in _ways_in(slot, _Hashed(controller, params))
            for way_in in ways
        )
    car = shape_of(params)
    site = site_of(slot, car, margins_of(0, params.apa))
    pose = to_slot(start, site.frame)
    if any(into_perpendicular(pose, share, site, car).found for share in range(SHARES)):
        return True
    return any(swing(pose, number, site, car).found for number in range(2 * SWING_ANGLES * SWING_WAYS))


class _Hashed:
    """Parameters of the controller, compared by what was changed."""

    def __init__(self, changes: dict[str, Any], params: ControllerParams) -> None:
        self._key = tuple(sorted(changes.items()))
        self.params = params

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Hashed) and self._key == other._key


@lru_cache(maxsize=64)
def _ways_in(slot: Slot, hashed: _Hashed) -> tuple[tuple[Site, Shape, tuple[Exit, ...]], ...]:
    """Return for each margin the ways into a parallel slot that keep to the shift limit."""
    params = hashed.params
    car = shape_of(params)
    found = []
    for attempt in range(ATTEMPTS):
        site = site_of(slot, car, margins_of(attempt, params.apa))
        ways = (exit_of(variant, site, car) for variant in range(VARIANTS))
        good = tuple(way for way in ways if way.found and way.moves + 1 <= params.apa.plan.manoeuvres)
        found.append((site, car, good))
    return tuple(found)
