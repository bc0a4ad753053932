"""Writes the table of docs/apa.md: every shipped car in every parking scenario. ``python docs/cars.py``."""

import re
from pathlib import Path

from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.grid.cars import park, parking_scenarios, shown
from orchestrator.scenario.files import car_names

PAGE = Path(__file__).parent / "apa.md"
BETWEEN = re.compile(r"(?<=<!-- cars -->\n).*?(?=\n<!-- /cars -->)", re.S)


def table() -> list[str]:
    """Return the table, a row for each scenario."""
    files = fmu_files("native", print)
    cars = car_names()
    lines = ["| | " + " | ".join(cars) + " |", "|---|" + "---|" * len(cars)]
    for name in parking_scenarios():
        cells = [shown(park(name, car, files)) for car in cars]
        print(name, cells, flush=True)
        lines.append(f"| `{name}` | " + " | ".join(cells) + " |")
    return lines


if __name__ == "__main__":
    PAGE.write_text(BETWEEN.sub("\n" + "\n".join(table()) + "\n", PAGE.read_text(encoding="utf-8")), encoding="utf-8")
