"""Thirty mistakes in what the papers print: constants, table cells, signs, guards. No golden record is asked."""

from pathlib import Path

from tests.mutants.listed import mutant_in
from tests.mutants.sites import Mutant

PRINTED: tuple[tuple[str, str, str], ...] = (
    ("guo2015/params.py", '"point tracking, heading gain", 0.0, 100.0, GUO)] = 4.0', "* 0.9"),
    ("guo2015/params.py", '"path tracking, heading gain", 0.0, 100.0, GUO)] = 0.8', "* 1.1"),
    (
        "guo2015/params.py",
        '"deviation at Q1 below which path tracking resumes", 0.0, 10.0, HOUSE)\n    ] = 0.05',
        "* 4.0",
    ),
    (
        "guo2015/params.py",
        '"Q1 to Q2 along the tangent", 0.1, 10.0, GUO + ", Table 2"), Role.FIXED\n    ] = 1.0',
        "* 1.1",
    ),
    ("guo2015/params.py", "Role.FIXED] = (\n        2.5\n", "* 1.0 - 0.1"),
    ("guo2015/params.py", "Role.FIXED] = (\n        5.5\n", "- 0.1"),
    ("guo2015/guards.py", "bit(Guard.AT_Q3, pose.x <= stop)", "bit(Guard.AT_Q3, pose.x <= 0.0)"),
    ("guo2015/guards.py", "(path, tracking.reference) <= stop", "(path, tracking.reference) <= 0.0"),
    ("guo2015/guards.py", "pose.x > q2.x or pose.y > q2.y", "pose.x > q2.x and pose.y > q2.y"),
    ("guo2015/guards.py", "abs(lateral) <= lateral_limit and", "abs(lateral) <= lateral_limit or"),
    ("guo2015/path_tracking.py", "feedforward = reference.curvature / (c_r * c_r * c_r)", "* c_r"),
    (
        "guo2015/legs.py",
        "return ahead(path.tangent2, params.q2_distance)",
        "return ahead(path.tangent1, params.q4_distance)",
    ),
    ("guo2015/prompts.py", "v * params.reaction + 0.5 * v * v", "v * params.reaction + v * v"),
    (
        "hsic/rules.py",
        "    (SpeedMode.TURN_ROUND, SteerMode.EXTREMUM_HOLD),\n",
        "    (SpeedMode.TURN_ROUND, SteerMode.PD),\n",
    ),
    ("hsic/params.py", '"gap to the neighbour at the ready point", 0.0, 5.0, PAPER)] = 0.5', "* 1.2"),
    ("hsic/params.py", '"largest lateral error of a parked car", 1e-4, 1.0, PAPER)] = 0.1', "* 1.5"),
    ("hsic/characteristic_states.py", "if found.distance > threshold.near:", "if found.distance < threshold.near:"),
    ("hsic/control.py", "line = line + gain.integral * now.integral", "line = line - gain.integral * now.integral"),
    ("hsic/stages.py", "share * threshold.parked_heading and abs", "share * threshold.parked_heading or abs"),
    ("hsic/stages.py", "READY_REACH = 0.3", "* 2.0"),
    ("preview/rule_tables.py", "    PB, PS, ZE, NS, NB,\n    PM", "    PB, ZE, ZE, NS, NB,\n    PM"),
    ("preview/rule_tables.py", "    NB, NS, PS, PM, PM,", "    NB, NS, PS, PM, PB,"),
    ("preview/params.py", '"td, far part of the period", 0.0, 100.0, PAPER)] = 0.2', "* 1.5"),
    ("preview/params.py", '"a1 of L1 = a1 v + a2", 0.0, 10.0, PAPER + ", (5)")] = 1.22', "* 0.99"),
    ("preview/params.py", '"speed-error rate that maps to 3", 1e-3, 1e6, PAPER)] = 1000.0', "* 0.5"),
    ("preview/sequence.py", "params.curve_slope * abs(curvature)", "params.curve_slope * curvature"),
    ("preview/preview.py", "- moved.left - moved.turned * l1", "+ moved.left - moved.turned * l1"),
    ("zhang2022/pid.py", "rate = (error - state.last_error) / dt", "rate = (state.last_error - error) / dt"),
    ("zhang2022/mpc.py", "HorizonStage(step, g, 0.5 * step * g, r,", "HorizonStage(step, g, step * g, r,"),
    ("zhang2022/quintic.py", "10.0 * rise - 6.0 * m0 - 4.0 * m1", "10.0 * rise - 6.0 * m0 + 4.0 * m1"),
)
"""File of ``controller_fmu``, what stands there once, what is to stand there; ``* X`` and ``- X`` are put behind it."""


def printed(root: Path) -> list[Mutant]:
    """Return the thirty."""
    return [mutant_in(root, *item) for item in PRINTED]
