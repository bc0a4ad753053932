"""Writes the ranges of docs/hunt.md: what differs in the study apa-world. ``python docs/world.py``."""

from pathlib import Path

from marked import put

from orchestrator.grid.world.factors import FACTORS
from orchestrator.sweep.study.space import Factor


def line(factor: Factor) -> str:
    """Return the row of a factor."""
    if factor.choices:
        counts = {word: factor.choices.count(word) for word in factor.choices}
        words = (word if count == 1 else f"{count} x {word}" for word, count in counts.items())
        return f"| `{factor.name}` | {', '.join(words)} | {factor.choices[int(factor.nominal)]} | {factor.text} |"
    unit = "" if factor.unit == "1" else f" {factor.unit}"
    return f"| `{factor.name}` | {factor.low:g} to {factor.high:g}{unit} | {factor.nominal:g} | {factor.text} |"


def table() -> list[str]:
    """Return the table."""
    return ["| factor | range | nominal | |", "|---|---|---|---|", *map(line, FACTORS)]


if __name__ == "__main__":
    put(Path(__file__).parent / "hunt.md", "world", table())
