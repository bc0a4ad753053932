"""The rooms of the repository: who may import whom, and how large files, folders and functions may be."""

import ast
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parent.parent
FLOORS: tuple[tuple[str, ...], ...] = (
    ("modelkit", "fmus", "orchestrator"),
    *(
        (f"orchestrator.{name}",)
        for name in ("inputs", "simulation", "evaluation", "presentation", "testing", "studies")
    ),
    ("vehicle_fmu", "controller_fmu"),
    ("fmus.cache_paths", "fmus.files", "fmus.children", "fmus.installation"),
    ("fmus.locks",),
    ("fmus.contents",),
    ("fmus.compiler.source",),
    ("fmus.compiler.slicing",),
    ("fmus.compiler.target",),
    ("fmus.compiler.constructs",),
    ("fmus.compiler",),
    ("fmus.native", "fmus.python", "fmus.systems", "fmus.model_fields"),
    ("fmus.study_slices",),
    ("fmus.compiled_batch",),
    ("fmus.compiled_episodes", "fmus.lane_rows"),
    ("fmus.build",),
    ("fmus.user_model", "fmus.policy_fmu", "fmus.sbom"),
    ("orchestrator.inputs.text",),
    ("orchestrator.inputs.scenario",),
    ("orchestrator.simulation.cosim",),
    ("orchestrator.simulation.imported",),
    ("orchestrator.simulation.system",),
    ("orchestrator.evaluation.verdict",),
    ("orchestrator.evaluation.comparison",),
    ("orchestrator.presentation.drawing",),
    ("orchestrator.presentation.log",),
    ("orchestrator.session.stream",),
    ("orchestrator.session",),
    ("orchestrator.presentation.report",),
    ("orchestrator.testing.steptest",),
    ("orchestrator.testing.suite", "orchestrator.testing.coverage"),
    ("orchestrator.testing.catalogue",),
    ("orchestrator.studies.sweep",),
    ("orchestrator.studies.identification",),
    ("orchestrator.studies.falsification",),
    ("orchestrator.studies.live",),
    ("orchestrator.presentation.export",),
    (
        "orchestrator.studies.papers",
        "orchestrator.studies.bakeoff",
        "orchestrator.studies.parking",
    ),
    ("orchestrator.studies.benchmark",),
    ("orchestrator.commands",),
    ("orchestrator.cli", "apa_cosim"),
    ("apa_cosim.gym",),
    ("orchestrator.__main__",),
)
"""A room imports rooms of the floors above its own line only, never one beside it."""
PACKAGES = ("inputs", "simulation", "evaluation", "presentation", "session", "testing", "studies", "commands", "cli")
"""The packages of the orchestrator; each imports only those before it."""
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
WITHOUT_FMI = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus.compiler")
"""These know of nothing but models."""
INSIDES = (
    "orchestrator.studies.papers",
    "orchestrator.studies.bakeoff",
    "orchestrator.studies.parking",
    "apa_cosim.gym",
)
"""Only these look into a model's package; the others take its ``MODEL``."""
MOST_LINES, MOST_PARAMETERS, MOST_WITH_MORE = 40, 6, 5
MAX_PACKAGES, MAX_ARROWS = 11, 28
FILES_PER_FOLDER = 20
"""More are reported, not refused: a folder is one idea, and some ideas have many parts."""
HOSTS = ("fmus", "orchestrator")


class Import(NamedTuple):
    """One module imported by another."""

    source: str
    target: str

    def __str__(self) -> str:
        return f"{self.source} imports {self.target}"


def files() -> Iterator[Path]:
    for package in ("modelkit", "vehicle_fmu", "controller_fmu", "apa_cosim", *HOSTS):
        yield from sorted((ROOT / package).rglob("*.py"))


def module_of(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


MODULES = {module_of(file): file for file in files()}


@cache
def tree_of(module: str) -> ast.Module:
    return ast.parse(MODULES[module].read_text(encoding="utf-8"))


def imports_of(module: str) -> Iterator[Import]:
    """Yield what a module imports of this repository, at its top or inside a function."""
    for node in ast.walk(tree_of(module)):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            inside = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name for name in inside if name in MODULES] or [node.module]
        else:
            continue
        yield from (Import(module, name) for name in names if name in MODULES)


@cache
def imports() -> list[Import]:
    """Return all of them: not when tests are collected, which each worker does."""
    return [item for module in MODULES for item in imports_of(module)]


def room_of(module: str) -> str:
    found = [room for room in FLOOR if module == room or (module.startswith(room + ".") and room not in HOSTS)]
    return max(found, key=len, default="")


def functions() -> Iterator[tuple[str, ast.FunctionDef]]:
    for module in MODULES:
        for node in ast.walk(tree_of(module)):
            if isinstance(node, ast.FunctionDef):
                yield f"{module}.{node.name}", node


def test_every_module_has_its_room() -> None:
    assert [name for name in MODULES if not room_of(name)] == []


def test_no_arrow_goes_up_or_aside() -> None:
    wrong = [
        str(item)
        for item in imports()
        if room_of(item.source) != room_of(item.target) and FLOOR[room_of(item.target)] >= FLOOR[room_of(item.source)]
    ]
    assert wrong == []


def test_the_packages_of_the_orchestrator_are_few_and_in_order() -> None:
    pairs = ((item.source.split(".")[:2], item.target.split(".")[:2]) for item in imports())
    arrows = {(a[1], b[1]) for a, b in pairs if a[0] == b[0] == "orchestrator" and len(a) == len(b) == 2 and a != b}
    wrong = [(a, b) for a, b in arrows if a != "__main__" and PACKAGES.index(b) >= PACKAGES.index(a)]
    assert wrong == []
    assert len(PACKAGES) <= MAX_PACKAGES
    assert len({(a, b) for a, b in arrows if a in PACKAGES[:-1]}) <= MAX_ARROWS


def test_no_files_import_each_other_in_a_circle() -> None:
    """What is left when files that import no other file left are taken away, again and again."""
    left = {module: {item.target for item in imports() if item.source == module} - {module} for module in MODULES}
    while free := {module for module, wanted in left.items() if not wanted & left.keys()}:
        left = {module: wanted for module, wanted in left.items() if module not in free}
    assert sorted(left) == []


def test_models_and_their_compiler_know_of_no_fmi() -> None:
    assert [str(item) for item in imports() if item.source.startswith(WITHOUT_FMI) and is_host(item)] == []


def is_host(item: Import) -> bool:
    return item.target.split(".")[0] in HOSTS and not item.target.startswith(WITHOUT_FMI)


@pytest.mark.parametrize("package", ["vehicle_fmu", "controller_fmu"])
def test_the_host_knows_the_insides_of_no_model(package: str) -> None:
    looks_inside = [
        str(item)
        for item in imports()
        if item.target.startswith(package + ".")
        and not item.source.startswith(package)
        and room_of(item.source) not in INSIDES
    ]
    assert looks_inside == []


def test_a_folder_of_many_files_is_reported(recwarn: pytest.WarningsRecorder) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        report_full_folders(dict.fromkeys(("small", "full"), 1) | {"full": FILES_PER_FOLDER + 1})
    assert [str(item.message) for item in recwarn] == [f"full has {FILES_PER_FOLDER + 1} files: is it one idea?"]


@pytest.mark.filterwarnings("default")
def test_no_folder_has_too_many_files() -> None:
    folders = {file.parent for file in MODULES.values()}
    report_full_folders({str(folder.relative_to(ROOT)): len(list(folder.glob("*.py"))) - 1 for folder in folders})


def report_full_folders(counts: dict[str, int]) -> None:
    for folder, count in counts.items():
        if count > FILES_PER_FOLDER:
            warnings.warn(f"{folder} has {count} files: is it one idea?", stacklevel=1)


def test_functions_are_short_and_few_take_many_parameters() -> None:
    """At most five in the whole code, and none of them in a model."""
    long, wide = [], []
    for name, node in functions():
        assert node.end_lineno is not None
        if node.end_lineno - node.lineno >= MOST_LINES:
            long.append(name)
        taken = [item.arg for item in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
        if len([item for item in taken if item not in ("self", "cls")]) > MOST_PARAMETERS:
            wide.append(name)
    assert long == []
    assert [name for name in wide if not name.startswith(HOSTS)] == []
    assert len(wide) <= MOST_WITH_MORE, wide


ONE_MEANING = {
    "Box": "a rectangle in the plane: of the scene, of the judge, of the outline",
    "StopCondition": "what ends a run before its stop time: in Python, in the batch in C",
    "Guard": "the conditions of a chart, one bit each",
    "Kerb": "a straight kerb: of the scene, of the judge",
    "Plan": "what a planner gives, with what it was made for",
    "Reference": "the point of the path that the car should be at",
}
"""Classes of one name in several rooms that do not import each other, and what the name means in all of them."""


def test_a_class_name_has_one_meaning() -> None:
    homes: dict[str, list[str]] = {}
    for module in MODULES:
        for node in tree_of(module).body:
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(module)
    twice = {name: found for name, found in homes.items() if len(found) > 1}
    assert {name: found for name, found in twice.items() if name not in ONE_MEANING} == {}
    assert [name for name in ONE_MEANING if name not in twice] == []
    assert [name for name, found in twice.items() if all(module.startswith("orchestrator.") for module in found)] == []


SHARED_BY_SYSTEMS = ("common",)
SYSTEMS = sorted(
    file.parent.name
    for file in (ROOT / "controller_fmu").glob("*/__init__.py")
    if file.parent.name not in SHARED_BY_SYSTEMS
)


@pytest.mark.parametrize("system", SYSTEMS)
def test_no_system_of_the_controller_imports_another(system: str) -> None:
    others = tuple(f"controller_fmu.{other}." for other in SYSTEMS if other != system)
    inside = f"controller_fmu.{system}."
    assert [str(item) for item in imports() if item.source.startswith(inside) and item.target.startswith(others)] == []


@pytest.mark.parametrize("shared", SHARED_BY_SYSTEMS)
def test_what_systems_share_knows_none_of_them(shared: str) -> None:
    systems = tuple(f"controller_fmu.{system}." for system in SYSTEMS)
    inside = f"controller_fmu.{shared}."
    assert [str(item) for item in imports() if item.source.startswith(inside) and item.target.startswith(systems)] == []


def test_only_the_package_imports_the_registry_of_systems() -> None:
    """What is below it knows no system: neither the interface nor any of them imports it."""
    above = {"controller_fmu", "controller_fmu.registry"}
    found = [item for item in imports() if item.source.startswith("controller_fmu") and item.source not in above]
    assert [str(item) for item in found if item.target in above] == []
    systems = tuple(f"controller_fmu.{system}" for system in SYSTEMS)
    below = ("controller_fmu.interface", *(f"controller_fmu.{shared}" for shared in SHARED_BY_SYSTEMS))
    assert [str(item) for item in found if item.source.startswith(below) and item.target.startswith(systems)] == []
