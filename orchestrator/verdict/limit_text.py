"""What a requirement asks for, in words."""

from orchestrator.scenario.requirements import Requirement
from orchestrator.text.readable import readable
from orchestrator.verdict.judge import Check

SIGNS = {"max": "\u2264", "min": "\u2265", "max_abs": "\u00b1", "equals": "="}


def limit_text(check: Check) -> str:
    """Return what is asked for, as people read it."""
    return f"{SIGNS[check.condition]} {check.limit_name or readable(check.limit, check.unit)}"


def asked(item: Requirement) -> str:
    """Return what a requirement asks for, before any run."""
    limit = item.limit
    return f"{SIGNS[item.condition]} {limit if isinstance(limit, str) else readable(limit, item.unit or '1')}"
