"""What a run says of an earlier one in its folder, which it replaces."""

from pathlib import Path
from typing import Any

from orchestrator.log.read_log import read_info
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.readable import WORDS

UNSEEN = (*WORDS, "changed", "base", "car", "expect")
SHOWN = 4


def replaced(log: Path, scenario: Scenario) -> str:
    """Return in words how the run in ``log`` differs from ``scenario``; empty if there is none or it does not."""
    before = read_info(log).get("scenario") if log.is_file() else None
    if not isinstance(before, dict):
        return ""
    old, new = _flat(before), _flat(scenario.model_dump(mode="json", exclude={"file"}))
    names = [name for name in {**old, **new} if old.get(name) != new.get(name)]
    if not names:
        return ""
    parts = [f"{name} {_text(old, name)} there, {_text(new, name)} here" for name in names[:SHOWN]]
    more = f"; and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{log.parent} has a run with other parameters, which this one replaces: {'; '.join(parts)}{more}"


def _flat(data: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in data.items():
        if not prefix and key in UNSEEN:
            continue
        if isinstance(value, dict):
            flat.update(_flat(value, f"{prefix}{key}."))
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def _text(values: dict[str, Any], name: str) -> str:
    text = str(values.get(name, "by default"))
    return text if len(text) <= 40 else "otherwise"
