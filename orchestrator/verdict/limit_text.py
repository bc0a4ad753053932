"""What a requirement asks for, in words."""

from orchestrator.scenario.requirements import Requirement
from orchestrator.text.readable import readable
from orchestrator.verdict.conditions import CONDITIONS
from orchestrator.verdict.judge import Check


def limit_text(check: Check) -> str:
    """Return what is asked for, as people read it."""
    return f"{CONDITIONS[check.condition].sign} {check.limit_name or readable(check.limit, check.unit)}"


def asked(item: Requirement) -> str:
    """Return what a requirement asks for, before any run."""
    limit = item.limit
    return f"{CONDITIONS[item.condition].sign} {limit if isinstance(limit, str) else readable(limit, item.unit or '1')}"
