"""A fixed list of mistakes in all packages, each with a test that detects it: what a faster test suite must not lose.

``python -m tests.mutants --fixed`` runs each mistake against its test alone. A mistake is put into the functions of a
forked process, not into a file, so that all packages are imported once only. Mistakes outside functions are therefore
not in the list; they are what ``--listed`` and the drawn ones are for.
"""

import ast
import contextlib
import gc
import hashlib
import importlib
import io
import multiprocessing
import os
import pkgutil
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, NamedTuple

import pytest

from tests.mutants.sites import Mutant, mutants_of

ROOT = Path(__file__).parents[2]
TABLE = Path(__file__).with_name("fixed.tsv")
HEAD = ("file", "before", "after", "count", "test")
PROJECT = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator", "apa_cosim")
NO_END = "no end"
LIMIT_OF_CPU = 40
"""Processor time [s] after which a mistake counts as detected, since its test does not end; a tenth is usual."""
LEAST_IN_CODE = 0.9
"""Share of the list that must still be in the code; below it a new list is due: ``--fixed --find``."""


class Row(NamedTuple):
    """One mistake and the test that detects it."""

    file: str
    before: str
    after: str
    count: int  # type: ignore[assignment]  # tuples have a method count
    test: str
    """``file::function`` below ``tests``."""


def read_table() -> list[Row]:
    """Return the list."""
    rows = [line.split("\t") for line in TABLE.read_text(encoding="utf-8").splitlines()[1:]]
    return [Row(file, before, after, int(count), test) for file, before, after, count, test in rows]


def write_table(rows: list[Row]) -> None:
    """Write the list."""
    lines = ["\t".join(map(str, row)) for row in [HEAD, *sorted(rows)]]
    TABLE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def located(row: Row) -> Mutant | None:
    """Return where the mistake is to be made; None if the code says something else by now."""
    if not (ROOT / row.file).exists():
        return None
    found = (item for item in mutants_of(ROOT, ROOT / row.file) if (item.before, item.after) == (row.before, row.after))
    return next((item for item in found if item.count == row.count), None)


def function_around(mutant: Mutant) -> ast.FunctionDef | None:
    """Return the outermost function in whose statements the mistake is made; None if there is none."""
    text = (ROOT / mutant.file).read_text(encoding="utf-8")
    last = mutant.line + mutant.before.count("\n")

    def search(nodes: list[ast.stmt]) -> ast.FunctionDef | None:
        for node in nodes:
            if isinstance(node, ast.ClassDef) and (found := search(node.body)):
                return found
            if not isinstance(node, ast.FunctionDef):
                continue
            if node.body[0].lineno <= mutant.line and last <= (node.end_lineno or 0):
                return node
        return None

    return search(ast.parse(text).body)


def codes_of(code: CodeType) -> Iterator[CodeType]:
    """Yield the code of all functions of a module and of its classes."""
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield item
            yield from codes_of(item)


def put_into_process(mutant: Mutant) -> None:
    """Give the functions of this process the code with the mistake."""
    around, path = function_around(mutant), ROOT / mutant.file
    assert around is not None, mutant
    module = compile(mutant.put_into(path.read_text(encoding="utf-8")), str(path), "exec", dont_inherit=True)
    first = min([around.lineno, *(item.lineno for item in around.decorator_list)])
    new = next(item for item in codes_of(module) if item.co_name == around.name and item.co_firstlineno == first)
    changed = 0
    gc.unfreeze()  # what a session of tests or a command has left out of the search
    for item in gc.get_objects():
        if type(item) is FunctionType and item.__code__.co_qualname == new.co_qualname:  # a proxy may be dead
            old = item.__code__
            if old.co_firstlineno == first and Path(old.co_filename).resolve() == path.resolve():
                item.__code__ = new
                changed += 1
    assert changed, f"{mutant.file}:{mutant.line}: no function {new.co_qualname} in this process"


def import_project() -> None:
    """Import all modules of all packages."""
    for name in PROJECT:
        package = importlib.import_module(name)
        for item in pkgutil.walk_packages(package.__path__, f"{name}."):
            if not item.name.endswith("__main__"):
                with contextlib.suppress(ImportError):
                    importlib.import_module(item.name)


def detected_by(mutant: Mutant | None, tests: list[str], limit: int = LIMIT_OF_CPU) -> str:
    """Return the first of ``tests`` that fails with the mistake, "" if none does; run in a forked process."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_run_tests, args=(mutant, tests, limit, sender))
    child.start()
    sender.close()
    try:
        return str(receiver.recv())
    except EOFError:
        return NO_END
    finally:
        child.join()


class FirstFailure:
    """Keeps the name of the first test that fails."""

    def __init__(self) -> None:
        self.name = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Look at one phase of a test."""
        if report.failed and not self.name:
            self.name = report.nodeid.removeprefix("tests/").split("[")[0]

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Look at a file."""
        if report.failed and not self.name:
            self.name = report.nodeid.removeprefix("tests/")


def _run_tests(mutant: Mutant | None, tests: list[str], limit: int, sender: Any) -> None:
    # Ends this process alone: a compiler that inherits a limit of processor time is killed, which detects nothing.
    signal.setitimer(signal.ITIMER_PROF, limit)
    failure = FirstFailure()
    words = ["-x", "-q", "-n0", "-p", "no:cacheprovider", "--hypothesis-seed=0", "-m", "not release"]
    words += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]  # the project is imported before pytest begins
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    os.chdir(ROOT)
    cache = tempfile.mkdtemp(prefix="mutant-")
    if mutant is not None:
        put_into_process(mutant)
        leave_cache(Path(cache))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        code = pytest.main([*words, *(f"tests/{name}" for name in tests)], plugins=[failure])
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    sender.send(failure.name if code in (0, 1, 5) else f"exit code {code}")
    sender.close()
    shutil.rmtree(cache, ignore_errors=True)
    os._exit(0)


def leave_cache(folder: Path) -> None:
    """Let this process keep what it builds in ``folder``: the hash of a source file knows nothing of a mistake here."""
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] in PROJECT and hasattr(module, "CACHE_FOLDER"):
            vars(module)["CACHE_FOLDER"] = folder


# Draws the list anew


def package_of(file: Path) -> str:
    """Return the package of a file: the second level in large packages."""
    return ".".join(file.relative_to(ROOT).parts[:-1][:2])


def tests_importing(module: str) -> list[str]:
    """Return the test files that import a module, small files first."""
    found = []
    for file in (ROOT / "tests").rglob("test_*.py"):
        text = file.read_text(encoding="utf-8")
        if (file.name != "test_benchmarks.py" and f"from {module} import" in text) or f"import {module}\n" in text:
            found.append(file)
    return [file.relative_to(ROOT / "tests").as_posix() for file in sorted(found, key=lambda file: file.stat().st_size)]


def candidates(package: str, seed: int) -> Iterator[tuple[Mutant, list[str]]]:
    """Yield mistakes in functions of a package with the test files that import the module, drawn without looking."""
    every = []
    for file in sorted((ROOT / package.replace(".", "/")).rglob("*.py")):
        module = file.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".").removesuffix(".__init__")
        tests = tests_importing(module) if package_of(file) == package else []
        if tests:
            every += [(item, tests[:2]) for item in mutants_of(ROOT, file) if "\t" not in item.before]
    key = lambda pair: hashlib.sha256(f"{seed} {pair[0].name}".encode()).digest()  # noqa: E731
    for mutant, tests in sorted(every, key=key):
        if "\n" not in mutant.before and function_around(mutant) is not None:
            yield mutant, tests


def packages() -> list[str]:
    """Return all packages, the large ones by their second level."""
    return sorted({package_of(file) for name in PROJECT for file in (ROOT / name).rglob("*.py")})


def draw(package: str, count: int, tries: int, seed: int) -> Iterator[Row]:
    """Yield up to ``count`` mistakes of a package that a test detects, of the first ``tries``."""
    found = 0
    for number, (mutant, tests) in enumerate(candidates(package, seed)):
        if number == tries or found == count:
            break
        test = detected_by(mutant, tests, limit=LIMIT_OF_CPU // 5)
        if "::" in test:
            found += 1
            yield Row(mutant.file, mutant.before, mutant.after, mutant.count, test)
