"""Writes the table of docs/apa.md: every shipped car in every parking scenario. ``python docs/cars.py``."""

from pathlib import Path

from marked import put

from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.grid.cars import park, parking_scenarios, shown
from orchestrator.scenario.files import car_names


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
    put(Path(__file__).parent / "apa.md", "cars", table())
