"""What a requirement asks for, and what a run has of it, in words."""

import math

from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.judge import NEVER, Check
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.text.readable import readable


def limit_text(check: Check) -> str:
    """Return the requirement, as people read it."""
    return f"{CONDITIONS[check.condition].sign} {check.limit_name or readable(check.limit, check.unit)}"


def requirement_text(item: Requirement) -> str:
    """Return what a requirement asks for, before any run."""
    limit = item.limit
    return f"{CONDITIONS[item.condition].sign} {limit if isinstance(limit, str) else readable(limit, item.unit or '1')}"


def sentence(check: Check) -> str:
    """Return value, limit, margin and moment of a check in one line."""
    if not check.evaluated:
        return f"{check.signal}: not measured, not evaluated"
    if math.isnan(check.value) and check.note == NEVER:
        hint = "" if check.passed else "; with if_never: pass it would be met"
        return f"{check.signal}: {check.note}, required {limit_text(check)}{hint}"
    value = check.note or readable(check.value, check.unit)
    margin = readable(check.margin, check.unit)
    return f"{check.signal}: {value} at {check.t:.3f} s, required {limit_text(check)}, margin {margin}"
