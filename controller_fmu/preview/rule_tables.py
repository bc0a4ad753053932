"""The rule tables of the two fuzzy controllers, Tables 1 and 2 of the preview paper, row by row.

Inputs NB NS ZE PS PB, outputs NB NM NS ZE PS PM PB as 0 to 6. Steering: rows lateral error yL,
columns heading error epsL. Force: rows speed error v - v_set, columns its rate.
"""

NB, NM, NS, ZE, PS, PM, PB = range(7)

STEERING_PRINTED = (
    NB, NB, NM, NB, NB,
    NM, NM, NS, PS, PB,
    NM, NS, ZE, PS, PM,
    PB, PS, PS, PM, PM,
    NB, NB, PM, PB, PB,
)  # fmt: skip
"""Table 1 as printed: four cells break the odd symmetry (row NB columns PS and PB, row PS columns NB and NS)."""

STEERING_SYMMETRIC = (
    NB, NB, NM, PB, PB,
    NM, NM, NS, PS, PB,
    NM, NS, ZE, PS, PM,
    NB, NS, PS, PM, PM,
    NB, NB, PM, PB, PB,
)  # fmt: skip
"""Table 1 with the four cells set so that rule(-yL, -epsL) = -rule(yL, epsL)."""

FORCE = (
    PB, PB, PB, PM, ZE,
    PB, PM, PS, PS, NM,
    PB, PS, ZE, NS, NB,
    PM, ZE, NS, NM, NB,
    ZE, NM, NB, NB, NB,
)  # fmt: skip
"""Table 2 as printed. One pair breaks odd symmetry, row NS column PS (PS) against row PS column NS (ZE); kept."""
