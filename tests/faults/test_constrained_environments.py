"""Every command in an environment that lacks something: the same result, or exit code 2 and one line.

An environment is a line of bash around the command ``"$@"``.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import pytest

from fmus.native.compilers import can_compile
from tests.faults.printed_result import result

ROOT = Path(__file__).parents[2]
SHORT = ["--fmus", "native", "--set", "stop_time=1", "--json"]
COMMANDS = {
    "run": ["run", "guo2015-case4", *SHORT, "--no-page"],
    "test": ["test", "guo2015-case4", *SHORT, "--set", "expected_outcome=not_parked"],
    "sweep": ["sweep", "few.yaml", "--fmus", "native", "--no-page", "--jobs", "1", "--json"],
    "falsify": ["falsify", "small.yaml", "--budget", "50", "--jobs", "1", "--json"],
}
STUDIES = {
    "few": "grid: {vehicle.start.x: [0, 0.01]}",
    "small": "monte_carlo: {n: 4, vehicle.start.x: {uniform: [0, 0.01]}, vehicle.start.y: {uniform: [0, 0.01]}}",
}
Expected = Literal["same", "refused", "either"]
SAME: Expected = "same"
REFUSED: Expected = "refused"
EITHER: Expected = "either"
LONGEST = 1800.0
"""A command that takes longer hangs, also on a machine with much else to do [s]."""
SHIM = 'export LD_PRELOAD="$SHIM"; '
IN = 'cp *.yaml "$there"; cd "$there"; "$@"'
DISK = 'mkdir out; bwrap --dev-bind / / --size {} --tmpfs "$PWD/out" -- '


class Environment(NamedTuple):
    """What is around a command."""

    line: str
    expected: Expected = SAME
    is_heard: bool = True
    """Whether the command can print."""


def _of(names: dict[str, str], expected: Expected = SAME, is_heard: bool = True) -> dict[str, Environment]:
    return {name: Environment(line, expected, is_heard) for name, line in names.items()}


def _limits(
    option: str, text: str, refused: Sequence[int] = (), either: Sequence[int] = (), same: Sequence[int] = ()
) -> dict[str, Environment]:
    """Return environments with limits of ``ulimit``."""
    values: tuple[tuple[Expected, Sequence[int]], ...] = (("refused", refused), ("either", either), ("same", same))
    return {
        f"{value} {text}": Environment(f'ulimit -{option} {value}; "$@"', expected)
        for expected, chosen in values
        for value in chosen
    }


ENVIRONMENTS = {
    **_of(
        {
            "nothing": '"$@"',
            "no home": 'unset HOME; "$@"',
            "home is a device": 'export HOME=/dev/null; "$@"',
            "home does not exist": 'export HOME=/nonexistent; "$@"',
            "empty environment": 'env -i PYTHONPATH="$PYTHONPATH" "$@"',
            "language C": 'export LC_ALL=C LANG=C; "$@"',
            "language C without UTF-8": 'export LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0; "$@"',
            "language that is not installed": 'export LC_ALL=xx_YY.ISO-8859-15; "$@"',
            "latin-1": 'export PYTHONIOENCODING=latin-1; "$@"',
            "ASCII": 'export PYTHONIOENCODING=ascii:strict; "$@"',
            "odd folder for temporary files": 'mkdir "t %# é"; export TMPDIR="$PWD/t %# é"; "$@"',
            "no folder for temporary files": 'export TMPDIR=/nonexistent; "$@"',
            "a file for temporary files": 'export TMPDIR=$PWD/few.yaml; "$@"',
            "no path of programs": 'unset PATH; "$@"',
            "no programs": 'export PATH=/nonexistent; "$@"',
            "far time zone": 'export TZ=Pacific/Kiritimati; "$@"',
            "time zone that there is not": 'export TZ=Nowhere/Nothing; "$@"',
            "terminal that there is not": 'export TERM=none COLUMNS=0 LINES=-1; "$@"',
            "narrow terminal": 'export COLUMNS=3; "$@"',
            "Python in development mode": 'export PYTHONDEVMODE=1; "$@"',
            "warnings are errors": 'export PYTHONWARNINGS=error::ResourceWarning; "$@"',
            "bytecode elsewhere": 'export PYTHONPYCACHEPREFIX=/dev/null/x; "$@"',
            "spaces": f"there='a  b '; mkdir \"$there\"; {IN}",
            "quotes": f"there='a\"b'\\''c'; mkdir \"$there\"; {IN}",
            "dollar": f"there='$HOME`x`'; mkdir \"$there\"; {IN}",
            "Japanese": f"there='駐車'; mkdir \"$there\"; {IN}",
            "a line break in the folder": f"there=$'a\\nb'; mkdir \"$there\"; {IN}",
            "a folder like an option": f'there=$PWD/--out; mkdir "$there"; {IN}',
            "mask 000": 'umask 000; "$@"',
            "mask 077": 'umask 077; "$@"',
            "mask 277": 'umask 277; "$@"',
            "mask 777": 'umask 777; "$@"',
            "Ctrl-C ignored": 'trap "" INT; "$@"',
            "SIGTERM ignored": 'trap "" TERM; "$@"',
            "ended children ignored": 'trap "" CHLD; "$@"',
            "broken pipes ignored": 'trap "" PIPE; "$@"',
            "no input": '"$@" <&-',
            "closed error stream": '"$@" 2>&-',
            "full error stream": '"$@" 2>/dev/full',
            "no core files": 'ulimit -c 0; "$@"',
            "no locked memory": 'ulimit -l 0; "$@"',
            "clock in 1969": f'{SHIM}APA_CLOCK_OFFSET=-1900000000 "$@"',
            "clock 400 days late": f'{SHIM}APA_CLOCK_OFFSET=-34560000 "$@"',
            "clock in 2200": f'{SHIM}APA_CLOCK_OFFSET=5500000000 "$@"',
            "clock runs backwards": f'{SHIM}APA_CLOCK_RATE=-1 "$@"',
            "clock stands": f'{SHIM}APA_CLOCK_RATE=0 "$@"',
            "temporary files on a disk that is read-only": 'bwrap --dev-bind / / --ro-bind "$TMPDIR" "$TMPDIR" -- "$@"',
        }
    ),
    **_of(
        {
            "closed output": '"$@" >&-',
            "no streams": '"$@" <&- >&- 2>&-',
            "reader that ends": '"$@" | true; exit ${PIPESTATUS[0]}',
            "both readers end": '"$@" 2>&1 | true; exit ${PIPESTATUS[0]}',
        },
        is_heard=False,
    ),
    **_of({"full output": '"$@" >/dev/full', "all full": '"$@" >/dev/full 2>&1'}, REFUSED, is_heard=False),
    **_of(
        {
            "folder that is gone": 'mkdir gone; cp *.yaml gone; cd gone; rm -r "$PWD"; "$@"',
            "no compiler": 'export CC=/nonexistent/cc APA_DIST="$PWD/dist"; "$@"',
            "compiler that fails": 'export CC=/bin/false APA_DIST="$PWD/dist"; "$@"',
            "folder that is read-only": 'bwrap --dev-bind / / --ro-bind "$PWD" "$PWD" --bind tmp "$TMPDIR" -- "$@"',
            "disk of 4 kB": f'{DISK.format(4096)}"$@"',
        },
        REFUSED,
    ),
    **_of(
        {
            "path of 3,500 letters": "there=$(printf 'd%.0s' {1..200}); "
            'for i in {1..17}; do mkdir "$there"; mv *.yaml "$there" 2>/dev/null; cd "$there"; done; '
            f'mkdir -p {"e" * 200}; cp *.yaml {"e" * 200}; cd {"e" * 200}; "$@"',
            "a folder that is no text": f"there=$'a\\xffb'; mkdir \"$there\"; {IN}",
            "Python -OO": 'export PYTHONOPTIMIZE=2; "$@"',
            "no shared memory": 'bwrap --dev-bind / / --ro-bind /sys /dev/shm -- "$@"',
            "disk of 64 kB": f'{DISK.format(65536)}"$@"',
            "disk of 1 MB": f'{DISK.format(1 << 20)}"$@"',
            "no threads": f'{SHIM}APA_NO_THREADS=1 "$@"',
            "no processes": f'{SHIM}APA_NO_PROCESSES=1 "$@"',
            "no processes and no library": f'{SHIM}APA_NO_PROCESSES=1 APA_DIST="$PWD/dist" "$@"',
            "folder of libraries that is read-only": 'export APA_DIST=/proc/none; "$@"',
        },
        EITHER,
    ),
    **_limits("n", "files", (5, 6), (8, 10, 13, 16, 20), (32,)),
    **_limits("v", "kB of memory", (100_000, 200_000), (300_000, 400_000, 700_000, 1_000_000), (2_000_000,)),
    **_limits("s", "kB of stack", (), (256,), (1024,)),
    **_limits("f", "kB of file", (0,), (1, 4, 8, 16, 32, 64, 256), (4096,)),
}
ON_EACH_CHANGE = ("no home", "6 files", "reader that ends")

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="limits are kept by Linux"),
    pytest.mark.skipif(not can_compile(), reason="needs a C compiler"),
]


class Ended(NamedTuple):
    """How a command ended."""

    code: int
    out: str
    err: str


@pytest.fixture(scope="module")
def shim(tmp_path_factory: pytest.TempPathFactory) -> Path:
    library = tmp_path_factory.mktemp("shim") / "odd.so"
    source = Path(__file__).with_name("odd_machine.c")
    command = ["gcc", "-shared", "-fPIC", "-O1", "-o", str(library), str(source), "-ldl"]
    if shutil.which("gcc") is None or subprocess.run(command, check=False).returncode:
        pytest.skip("needs gcc")
    return library


@pytest.fixture(scope="module")
def references() -> dict[str, tuple[int, Any]]:
    return {}


def run_in(line: str, command: str, folder: Path, shim: Path) -> Ended:
    """Return how a command ends in an environment."""
    folder.mkdir()
    (folder / "tmp").mkdir()
    for name, runs in STUDIES.items():
        text = f"name: {name}\nscenario: guo2015-case4\nset: {{stop_time: 1}}\nruns:\n  {runs}\n"
        (folder / f"{name}.yaml").write_text(text)
    environment = os.environ | {"PYTHONPATH": str(ROOT), "SHIM": str(shim), "TMPDIR": str(folder / "tmp")}
    words = ["bash", "-c", line, "bash", sys.executable, "-m", "orchestrator", *COMMANDS[command], "--out", "out"]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, check=False, timeout=LONGEST)
    return Ended(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))


def check(name: str, command: str, tmp_path: Path, shim: Path, references: dict[str, tuple[int, Any]]) -> Ended:
    """Check how a command ends in an environment; return it."""
    if command not in references:
        plain = run_in('"$@"', command, tmp_path / "plain", shim)
        assert plain.code in (0, 1), plain
        references[command] = plain.code, result(command, plain.out)
    line, expected, is_heard = ENVIRONMENTS[name]
    ended = run_in(line, command, tmp_path / "odd", shim)
    assert "Traceback" not in ended.err, ended
    assert "internal error" not in ended.err, ended
    code, found = references[command]
    assert ended.code in {SAME: (code,), REFUSED: (2,), EITHER: (code, 2)}[expected], ended
    if is_heard and ended.code == code:
        assert result(command, ended.out) == found, ended
    elif is_heard:
        lines = [text for text in ended.err.splitlines() if text.startswith("apa: ") and "warning" not in text]
        assert len(lines) == 1 or (command == "test" and '"error": "' in ended.out), ended
    return ended


@pytest.mark.parametrize("name", ON_EACH_CHANGE)
def test_a_run_in_an_environment_that_lacks_something(
    name: str, tmp_path: Path, shim: Path, references: dict[str, tuple[int, Any]]
) -> None:
    check(name, "run", tmp_path, shim, references)


@pytest.mark.release
@pytest.mark.parametrize("name", ENVIRONMENTS)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_in_every_environment(
    command: str, name: str, tmp_path: Path, shim: Path, references: dict[str, tuple[int, Any]]
) -> None:
    """With ``-s`` it prints the list: command, environment, exit code."""
    if "bwrap" in ENVIRONMENTS[name].line and shutil.which("bwrap") is None:
        pytest.skip("needs bubblewrap")
    print(f"{command}\t{name}\t{check(name, command, tmp_path, shim, references).code}")
