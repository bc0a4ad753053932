"""Check the vocabulary: ``python -m tests.vocabulary``; ``make lint`` runs it.

No package may have more findings than ``allowed.tsv`` states, and the numbers there only go down.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from tests.vocabulary.findings import counts, findings, package, tracked, unclear

ROOT = Path(__file__).parents[2]
ALLOWED = Path(__file__).with_name("allowed.tsv")
BASE = "3b7160b1"
"""Subjects of commits after this one are checked."""
LANDED = frozenset(
    {
        "docs: state what the parking system does in the studies of slots at all angles",
        "mutants: name mistakes in the parking system and the tests that find them",
        "ci: install with uv, build an FMU of the same content once, recipes compile once",
        "parking: map oblique sides where the cone's boundary meets them, find their rows",
        "studies: take slot types and shortest slots from the standards, not a system",
    }
)
"""Longer subjects that are part of the history."""
PASSED, FAILED = 0, 1


def allowed() -> dict[str, int]:
    """Return package -> most findings."""
    lines = ALLOWED.read_text(encoding="utf-8").splitlines()
    return {name: int(count) for name, count in (line.split("\t") for line in lines[1:])}


def subjects(base: str) -> list[str]:
    """Return the subjects of the commits since ``base``; none where the history does not reach back so far."""
    words = ["git", "log", "--no-merges", "--format=%s", f"{base}..HEAD"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    return [text for text in done.stdout.splitlines() if text not in LANDED] if done.returncode == 0 else []


def main() -> int:
    """Print what is wrong. Returns 1 if a package has more findings than before, or a subject is unclear."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0], prog="python -m tests.vocabulary")
    parser.add_argument("package", nargs="?", help="list the places of this package")
    parser.add_argument("--update", action="store_true", help="lower the numbers in allowed.tsv")
    parser.add_argument("--commits", metavar="BASE", default=BASE, help="check the subjects since this commit")
    arguments = parser.parse_args()
    found = list(findings(ROOT, tracked(ROOT)))
    if arguments.package:
        for item in found:
            if package(item.file) == arguments.package:
                print(f"{item.file}:{item.line}: {item.word} -> {item.term}")
        return PASSED
    now, most = counts(found), allowed()
    if arguments.update:
        kept = {name: min(count, most.get(name, count)) for name, count in sorted(now.items())}
        lines = ["package\tfindings", *(f"{name}\t{count}" for name, count in kept.items())]
        ALLOWED.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return PASSED
    more = {name: count for name, count in now.items() if count > most.get(name, 0)}
    for name, count in sorted(more.items()):
        print(f"{name}: {count} findings, allowed {most.get(name, 0)}; list them: python -m tests.vocabulary {name}")
    wrong = [f"commit {text!r}: {why}" for text in subjects(arguments.commits) if (why := unclear(text))]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    less = sum(max(count - now[name], 0) for name, count in most.items())
    if less and not more:
        print(f"{less} findings fewer than allowed: python -m tests.vocabulary --update")
    print(f"vocabulary: {len(found)} findings, {len(more)} packages with more than allowed, {len(wrong)} subjects")
    return FAILED if more or wrong else PASSED


if __name__ == "__main__":
    sys.exit(main())
