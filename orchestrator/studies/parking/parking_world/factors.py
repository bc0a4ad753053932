"""What differs from run to run beside the factors of ``apa-world``, and the ranges that are wider than there."""

from orchestrator.studies.parking.world import factors as world
from orchestrator.studies.sweep.study.space import Factor

NONE, HITCH, RACK = 0, 1, 2
WALL, PARKED_CARS = 1, 2
FIRST_BEND = 3
"""Choices of the factor ``bend`` from this one on: the road bends."""
FIRST_ANGLED = 4
"""Choices of the factor ``angled`` from this one on: the row stands at an angle."""
NO_BAYS = 2
"""Choices of the factor ``bays`` up to this one: no bay lines; beyond it, the number of empty bays."""
ROW = (
    Factor("cars_a", "1", 0, 0, 3, "cars beyond the first neighbour", ("0", "1", "2", "3")),
    Factor("cars_b", "1", 0, 0, 3, "cars beyond the second neighbour", ("0", "1", "2", "3")),
    Factor("gap_a", "m", 0.4, 0.8, 1.2, "between the cars beyond the first neighbour"),
    Factor("gap_b", "m", 0.4, 0.8, 1.2, "between the cars beyond the second neighbour"),
)
SURROUNDINGS = (
    Factor("opposite", "1", 0, 0, 2, "across the road", ("nothing", "wall", "parked cars")),
    Factor("street", "m", 5.0, 7.0, 10.0, "from the slot's mouth to what stands across the road"),
    Factor("overhang", "1", 0, 0, 2, "at the first neighbour, towards the slot or the road", ("none", "hitch", "rack")),
    Factor("overhang_length", "m", 0.1, 0.2, 0.6, "how far the hitch or rack stands out"),
    Factor("pillar", "1", 0, 0, 3, "beside the slot's mouth", ("none", "none", "at the first", "at the second")),
    Factor("bin", "1", 0, 0, 9, "in the slot, which is then none", (*("none",) * 9, "bin")),
    Factor("lost_count", "1", 0, 0, 11, "sensors that fail at once", tuple(map(str, range(1, 13)))),
)
BAYS = (
    Factor(
        "bays", "1", 0, 0, 5, "empty bays of a perpendicular row with lines", ("none", "none", "none", "1", "2", "3")
    ),
    Factor("bay", "m", 2.3, 2.5, 2.9, "width of a bay"),
)
TURN = (
    Factor("person_turn", "1", 0, 0, 3, "before the slots a pedestrian goes", ("on", "on", "forwards", "backwards")),
    Factor("person_turn_at", "m", 0.6, 1.0, 2.0, "from the slots, where a pedestrian turns along the road"),
)
RAMP = Factor("ramp", "%", -12.0, 0.0, 12.0, "slope of a perpendicular slot, into it; double-track")
BEND = (
    Factor("bend", "1", 0, 0, 4, "the road bends, the slots are", ("none", "none", "none", "inside", "outside")),
    Factor("bend_radius", "m", 30.0, 100.0, 100.0, "of the row along the bend"),
)
ANGLED = (
    Factor(
        "angled",
        "1",
        0,
        0,
        5,
        "row at an angle to the road, and how the vehicle parks in it",
        (*("no",) * 4, "nose in", "tail in"),
    ),
    Factor("lean", "deg", 10.0, 30.0, 45.0, "of the cars of an angled row, from perpendicular"),
)
WIDER = {
    **{"person_speed": (0.5, 2.5), "slope": (-12.0, 12.0), "bank": (-12.0, 12.0), "kerb_height": (0.03, 0.2)},
    **{"length_a": (3.6, 5.4), "length_b": (3.6, 5.4)},
}
"""Ranges of factors of ``apa-world``, by name."""
OWN = (*ROW, *SURROUNDINGS, *BAYS, *TURN, RAMP, *BEND, *ANGLED)


def _widen(factor: Factor) -> Factor:
    low, high = WIDER.get(factor.name, (factor.low, factor.high))
    return factor._replace(low=low, high=high)


FACTORS = (*map(_widen, world.FACTORS), *OWN)
