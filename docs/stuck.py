"""Writes the table of docs/guo2015.md: steerings that stick, and real ones that do not. ``python docs/stuck.py``."""

from pathlib import Path

from marked import put

from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.grid.stuck_wheel import BASES, HEADS, StuckDrive, drive, line_of

STUCK, HEALTHY = 334, 200


def drives(system: str, sticks: bool, count: int) -> list[StuckDrive]:
    """Return the drives of a system."""
    files = fmu_files("native", print)
    return [drive(system, number, sticks, files, "native") for number in range(count)]


def table() -> list[str]:
    """Return the table, a line for each system."""
    lines = ["| " + " | ".join(HEADS) + " |", "|---|" + "---:|" * (len(HEADS) - 1)]
    for system in BASES:
        cells = line_of(f"`{system}`", drives(system, True, STUCK), drives(system, False, HEALTHY))
        print(cells, flush=True)
        lines.append("| " + " | ".join(cells) + " |")
    return lines


if __name__ == "__main__":
    put(Path(__file__).parent / "guo2015.md", "stuck", table())
