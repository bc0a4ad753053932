"""What a command printed with ``--json`` says of its runs."""

import json
from typing import Any


def result(command: str, printed: str) -> Any:
    """Return what a command came to, without times."""
    found = json.loads(printed)
    if command == "run":
        return [found[name] for name in ("outcome", "reason", "final", "duration")]
    if command == "test":
        return [[item["outcome"], item["passed"]] for item in found["scenarios"]]
    return [found[name] for name in (("count", "done") if command == "sweep" else ("runs", "broken"))]
