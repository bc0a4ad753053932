"""What was made of a log and lies beside it, under the names that commands give."""

from pathlib import Path

from orchestrator.inputs.text.console import say

MADE_OF_A_LOG = ("summary.json", "overview.png", "report.html", "live.html")
EXPORTS = (".csv", ".mf4", ".rrd")
"""These no run makes anew."""


def clear(log: Path) -> None:
    """Remove what was made of an earlier log in the place of ``log``, and warn of what no run makes again."""
    exports = [log.with_suffix(suffix).name for suffix in EXPORTS]
    found = [name for name in (*MADE_OF_A_LOG, *exports) if (log.parent / name).is_file()]
    for name in found:
        (log.parent / name).unlink()
    gone = [name for name in found if name in exports]
    if gone:
        say(f"apa: removed {', '.join(gone)} of the run before")
