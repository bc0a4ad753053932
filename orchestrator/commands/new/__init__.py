"""``apa new``: a controller, a vehicle, a scenario, a study or a pipeline of your own that runs at once."""

import argparse
import keyword
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from string import Template

from fmus.files import whole_folder, write_whole
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.trust import trust_folder

EXAMPLES = """examples:
  apa new controller my_controller          a folder my_controller: law, scenario, tests, README
  apa run my_controller/scenario.yaml       compiles it and drives it
  apa run guo2015-case3 --controller my_controller:MODEL
  apa new controller learned --from policy.onnx   a folder learned: an FMU that runs the policy, scenario, README
  apa new vehicle my_car
  apa new scenario my-slot                  my-slot.yaml: a slot, its neighbours, kerb and target from one key
  apa new scenario --controller their.fmu   their.yaml: connections suggested by names, units and descriptions
  apa new study my-study --scenario my-slot.yaml
  apa new ci my_controller                  pipelines of GitHub and GitLab that test and ship it
  apa new ci --fmu their.fmu                pipelines that test an FMU
"""
KINDS = ("controller", "vehicle", "scenario", "study", "ci")
PACKAGES = ("controller", "vehicle")
PIPELINES = {"github.yml": ".github/workflows/{name}.yml", "gitlab.yml": ".gitlab-ci.yml"}
"""Template -> where the server looks for it."""
FOR_FMU = "fmu-"
"""Begins the templates of the pipelines that test an FMU."""
TEMPLATE_FOLDER = Path(__file__).parent / "templates"
SUFFIX = ".txt"
RESERVED = ("apa_cosim", "fmus", "modelkit", "orchestrator", "pythonfmu", "vehicle_fmu", "controller_fmu")
BASE = "guo2015-case4"
NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")
START_RANGE = 0.1
"""A new study varies the start pose by so much to either side [m]."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("kind", choices=KINDS, metavar="KIND", help=", ".join(KINDS))
    parser.add_argument(
        "name", nargs="?", default="", metavar="NAME", help="name of the package or file (default: that of the FMU)"
    )
    parser.add_argument(
        "--out", type=Path, default=Path(), metavar="DIR", help="output folder (default: current folder)"
    )
    parser.add_argument("--from", dest="policy", type=Path, metavar="ONNX", help="controller: a learned policy")
    parser.add_argument(
        "--period", type=float, metavar="S", help="--from: between actions (default: that of the environments, 0.2)"
    )
    parser.add_argument("--controller", metavar="FMU", help="scenario: a third-party FMU as controller")
    parser.add_argument("--vehicle", metavar="FMU", help="scenario: a third-party FMU as vehicle")
    parser.add_argument("--fmu", metavar="FMU", help="scenario, ci: a third-party FMU; its variables decide its role")
    parser.add_argument(
        "--scenario", metavar="NAME|FILE", help="scenario, study: scenario that it extends; ci: scenario that it runs"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files and say what to do with them. Returns 0."""
    kind: str = arguments.kind
    allowed = {
        "scenario": ("controller", "vehicle", "fmu", "scenario"),
        "study": ("scenario",),
        "ci": ("fmu", "scenario"),
    }
    for option in ("controller", "vehicle", "fmu", "scenario"):
        if getattr(arguments, option) and option not in allowed.get(kind, ()):
            takers = ", ".join(name for name, options in allowed.items() if option in options)
            raise BadInput(f"is not for apa new {kind}; it is for {takers}", key=f"--{option}")
    if kind == "scenario":
        return _scenario(arguments)
    if kind == "study":
        return _study(arguments)
    if kind == "ci" and arguments.fmu:
        return _pipelines_of_fmu(arguments)
    if arguments.scenario:
        raise BadInput("needs --fmu: the pipelines of a package run the scenario in it", key="--scenario")
    name = _package_name(arguments.name)
    if arguments.policy is not None:
        if kind != "controller":
            raise BadInput("is for apa new controller", key="--from")
        return _policy(arguments.out, name, arguments.policy, arguments.period)
    return _write_pipelines(arguments.out, name) if kind == "ci" else _package(kind, arguments.out, name)


def _package_name(name: str) -> str:
    if not name:
        raise BadInput("is missing: apa new KIND NAME", key="NAME")
    is_name = name.isidentifier() and name.isascii() and not keyword.iskeyword(name)
    if not is_name or name in RESERVED or name in sys.stdlib_module_names:
        text = "is no name for a package: write letters, digits and _, and no word or module of Python or apa"
        raise BadInput(text, key=name)
    return name


def _file_name(name: str) -> str:
    plain = name.removesuffix(".yaml").removesuffix(".yml")
    if not plain:
        raise BadInput("is missing: apa new KIND NAME", key="NAME")
    if NAME.fullmatch(plain) is None:
        raise BadInput("is no name for a file: write letters, digits, _, - and .; --out DIR says where", key=name)
    return plain


def _package(kind: str, out: Path, name: str) -> int:
    """Write a package: law, scenario, tests."""
    folder = out / name
    with _new_folder(folder) as made:
        _write_templates(kind, made, name)
    print(f"{folder}: law, scenario, tests, README\nnext: apa run {folder}/scenario.yaml")
    return 0


def _policy(out: Path, name: str, network: Path, given_period: float | None) -> int:
    """Write the FMU of a learned policy, a scenario and a README."""
    from fmus.policy_fmu import ACTION_PERIOD, BadPolicy, build_policy_fmu

    period = ACTION_PERIOD if given_period is None else given_period
    folder = out / name
    with _new_folder(folder) as made:
        if not network.is_file():
            raise BadInput("no such file", file=network)
        try:
            build_policy_fmu(name, network, period, made)
        except BadPolicy as error:
            raise BadInput(str(error), file=network) from error
        _write_templates("policy", made, name, period=f"{period:g}")
    print(f"{folder}: {name}.fmu, scenario, README\nnext: apa run {folder}/scenario.yaml")
    return 0


@contextmanager
def _new_folder(folder: Path) -> Iterator[Path]:
    """Give a folder to write, moved to its place when it is complete; then trust it."""
    if folder.exists():
        raise BadInput("is there already", file=folder)
    with whole_folder(folder) as made:
        yield made
    trust_folder(folder)


def _write_templates(kind: str, folder: Path, name: str, **words: str) -> None:
    for template in sorted((TEMPLATE_FOLDER / kind).glob(f"*{SUFFIX}")):
        _write(template, folder / template.name.removesuffix(SUFFIX), name, **words)


def _third_party(arguments: argparse.Namespace) -> dict[str, str]:
    """Return component -> FMU of those that were named; ``--fmu`` is placed by its variables."""
    files = {owner: getattr(arguments, owner) for owner in PACKAGES if getattr(arguments, owner, None)}
    if arguments.fmu:
        from orchestrator.session.fmu_check import likely_place
        from orchestrator.session.foreign import fmu_of
        from orchestrator.simulation.cosim.model_description import read_description

        path = fmu_of(arguments.fmu)
        place = likely_place(path, read_description(path), "")
        if place in files:
            raise BadInput(f"is a {place}, by its variables, and --{place} names another", key="--fmu")
        files[place] = arguments.fmu
    return files


def _scenario(arguments: argparse.Namespace) -> int:
    """Write a scenario: a template, or a system with suggested connections."""
    files = _third_party(arguments)
    name = _file_name(arguments.name or _stem(next(iter(files.values()), "")))
    file = _new_file(arguments.out / f"{name}.yaml")
    if files:
        _write_system(file, name, arguments.scenario or BASE, files)
    elif arguments.scenario:
        raise BadInput("needs --controller, --vehicle or --fmu; a template is complete by itself", key="--scenario")
    else:
        _write(TEMPLATE_FOLDER / "scenario" / f"scenario.yaml{SUFFIX}", file, name, file=str(file))
        print(f"{file}: a parallel slot\nnext: apa run {file}")
    return 0


def _write_system(file: Path, name: str, base: str, files: Mapping[str, str]) -> None:
    from orchestrator.commands.new.scenario_file import scenario_of_fmus

    made = scenario_of_fmus(name, base, files, file.parent)
    write_whole(file, made.text)
    print(f"{file}: {made.suggestions} suggested lines, marked '# ?'; check signal, unit and sign")
    if made.open_lines:
        print(f"{made.open_lines} lines are commented out: fill them in, or delete them")
    if made.open_signals:
        print(f"nothing suggested for {', '.join(made.open_signals)}")
    check = next(iter(files.values()))
    print(f"next: apa fmu check {check} --scenario {file}\n      apa run {file} --trust")


def _study(arguments: argparse.Namespace) -> int:
    """Write a study of a scenario's start pose."""
    from orchestrator.inputs.scenario.load_scenario import load_scenario

    name = _file_name(arguments.name)
    file = _new_file(arguments.out / f"{name}.yaml")
    base = arguments.scenario or BASE
    scenario = load_scenario(base)
    given = scenario.parameters_of("vehicle")
    if scenario.system is not None and "vehicle" in scenario.system.files():
        raise BadInput(
            "has a vehicle of its own, whose parameters only you know: docs/studies.md has the file", key=base
        )
    x, y, heading = (float(given.get(f"start.{axis}", 0.0)) for axis in ("x", "y", "heading"))
    seen = _relative_path(file.parent, base) if base.endswith((".yaml", ".yml")) else base
    ends = {"left": x - START_RANGE, "right": x + START_RANGE, "low": y - START_RANGE, "high": y + START_RANGE}
    words = {key: f"{value:.6g}" for key, value in {**ends, "heading": heading}.items()}
    _write(TEMPLATE_FOLDER / "study" / f"study.yaml{SUFFIX}", file, name, file=str(file), scenario=seen, **words)
    print(f"{file}: 24 runs of {base}\nnext: apa sweep {file}")
    return 0


def _pipelines_of_fmu(arguments: argparse.Namespace) -> int:
    """Write pipelines that check an FMU and test its scenario, which is written where there is none."""
    name = _file_name(arguments.name or _stem(arguments.fmu))
    scenario = Path(arguments.scenario) if arguments.scenario else arguments.out / f"{name}.yaml"
    arguments.controller = arguments.vehicle = None
    files = _third_party(arguments)
    words = {
        "fmu": _relative_path(arguments.out, arguments.fmu),
        "scenario": _relative_path(arguments.out, str(scenario)),
    }
    _check_new(arguments.out, name)
    if not scenario.exists():
        if arguments.scenario:
            raise BadInput("no such file", file=scenario)
        _write_system(scenario, name, BASE, files)
    return _write_pipelines(arguments.out, name, FOR_FMU, **words)


def _relative_path(folder: Path, place: str) -> str:
    return Path(os.path.relpath(place, folder)).as_posix()


def _check_new(out: Path, name: str) -> None:
    for place in PIPELINES.values():
        _new_file(out / place.format(name=name))


def _write_pipelines(out: Path, name: str, kind: str = "", **words: str) -> int:
    """Write what a server runs at every push: tests and ships the package, or tests the FMU."""
    _check_new(out, name)
    files = {template: out / place.format(name=name) for template, place in PIPELINES.items()}
    for template, file in files.items():
        _write(TEMPLATE_FOLDER / "ci" / f"{kind}{template}{SUFFIX}", file, name, **words)
    print(f"{', '.join(map(str, files.values()))}\nnext: write into them where apa-cosim is installed from")
    return 0


def _new_file(file: Path) -> Path:
    if file.exists():
        raise BadInput("is there already", file=file)
    return file


def _stem(place: str) -> str:
    """Return the name of an FMU without folder and suffix, with _ for what no file name has."""
    return re.sub(r"[^A-Za-z0-9_.-]", "_", Path(place.partition(":")[0]).name.removesuffix(".fmu").removesuffix(".py"))


def _write(template: Path, to: Path, name: str, **more: str) -> None:
    title = "".join(part[:1].upper() + part[1:] for part in name.split("_"))
    text = Template(template.read_text(encoding="utf-8")).substitute({"name": name, "title": title, **more})
    write_whole(to, text)
