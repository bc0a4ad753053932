"""Twenty plausible mistakes in NTBPTcwPT (Guo 2015): signs, gains, thresholds, guards, transitions."""

from pathlib import Path

from tests.mutants.sites import Mutant

LISTED: tuple[tuple[str, str, str], ...] = (
    ("path_tracking.py", "+ k1 * distance", "- k1 * distance"),
    ("path_tracking.py", "- k2 * slope", "+ k2 * slope"),
    ("path_tracking.py", "(feedforward + k1", "(-feedforward + k1"),
    ("path_tracking.py", "c * c * c * (feed", "c * (feed"),
    ("point_tracking.py", "(-k3 * error.y", "(k3 * error.y"),
    ("point_tracking.py", "- direction * k4", "+ direction * k4"),
    ("params.py", '"path tracking, distance gain", 0.0, 100.0, GUO)] = 1.0', "* 2.0"),
    ("params.py", '"path tracking, heading gain", 0.0, 100.0, GUO)] = 0.8', "* 2.0"),
    ("params.py", '"point tracking, distance gain", 0.0, 100.0, GUO)] = 1.0', "* 2.0"),
    ("params.py", '"point tracking, heading gain", 0.0, 100.0, GUO)] = 4.0', "* 0.5"),
    ("params.py", "] = 0.154", "* 2.0"),
    ("guards.py", "bit(Guard.OFF_PATH, points and left)", "bit(Guard.OFF_PATH, points and not left)"),
    ("guards.py", "bit(Guard.PAST_Q2, pose.x > q2.x or pose.y > q2.y)", "bit(Guard.PAST_Q2, pose.x > q2.x)"),
    ("guards.py", "bit(Guard.AT_Q1_RIGHT, at_q1 and resumed)", "bit(Guard.AT_Q1_RIGHT, at_q1)"),
    ("guards.py", "at_q1 = tracking.ahead <= 0.0", "at_q1 = tracking.ahead >= 0.0"),
    ("legs.py", "direction = 1.0 if leg in (GuoPhase.TO_Q2, GuoPhase.TO_Q4) else -1.0", "direction = 1.0"),
    ("chart.py", "    _row(GuoPhase.PATH_TRACKING, Guard.OFF_PATH, GuoPhase.STOP, GuoPhase.TO_Q2),\n", ""),
    ("chart.py", "    _row(GuoPhase.STOP, Guard.STANDING_AT_END_WRONG, GuoPhase.PRE_STEER, GuoPhase.TO_Q4),\n", ""),
    ("chart.py", "    _row(GuoPhase.TO_Q4, Guard.PAST_Q4, GuoPhase.STOP, GuoPhase.TO_Q3),\n", ""),
    (
        "path.py",
        "return Reference(x, y, math.asin(sine), -1.0 / r, piece)",
        "return Reference(x, y, math.asin(sine), 1.0 / r, piece)",
    ),
)
"""File, what stands there once, what is to stand there; ``* FACTOR``: the same, times that."""


def listed(root: Path) -> list[Mutant]:
    """Return the twenty."""
    return [mutant_in(root, f"guo2015/{name}", before, after) for name, before, after in LISTED]


def mutant_in(root: Path, name: str, before: str, after: str) -> Mutant:
    """Return the mutant of the controller's file ``name`` that says ``after`` where ``before`` stands once."""
    file = Path("controller_fmu") / name
    text = (root / file).read_text(encoding="utf-8")
    assert text.count(before) == 1, f"{file}: {before!r} stands there {text.count(before)} times"
    begin = len(text[: text.index(before)].encode())
    whole = f"{before} {after}" if after.startswith(("* ", "- ")) else after
    line = text[: text.index(before)].count("\n") + 1
    return Mutant(file.as_posix(), line, begin, begin + len(before.encode()), before, whole, "listed")
