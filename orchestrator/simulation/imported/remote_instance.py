"""An FMU in a process of its own: it may crash, hang or leave, and the run only ends with a reason.

Every order has a limit of wall-clock time. Numbers lie in memory that both processes have, orders go through pipes, one
a step: see ``worker``.
"""

import json
import os
import secrets
import select
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from math import isnan
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from fmus.children import LIVING, end, own_process
from fmus.files import new_folder, remove_folder
from modelkit.model import Model
from orchestrator.inputs.text.errors import RESOURCES, NotRunError, RunError, excerpt
from orchestrator.inputs.text.printable import printable
from orchestrator.inputs.text.quantities import MOST_WHOLE
from orchestrator.simulation.cosim.fmu_instance import Indices, Ports
from orchestrator.simulation.cosim.model_description import (
    element_names,
    has_variable_step,
    ports_of,
    read_description,
    text_parameters,
)
from orchestrator.simulation.cosim.python_fmu import instantiation_message
from orchestrator.simulation.imported import worker
from orchestrator.simulation.imported.archive import binary, check_archive, unpack
from orchestrator.simulation.imported.limits import FmuLimits
from orchestrator.simulation.imported.sandbox import sandbox_command
from orchestrator.simulation.imported.shared_numbers import SharedNumbers

EXIT_TIMEOUT = 2.0
"""For a process to end that has nothing to say any more [s]."""
POLL_INTERVAL = 0.05
"""Between two looks at the clock [s]."""
MAX_PRINTED = 1 << 20
"""What a process printed is forgotten beyond so much [bytes]."""
WIDE = ("UInt32", "Int64", "UInt64", "Enumeration")
"""Types of FMI 3.0 that hold more than 32-bit integers."""
ANSWERS = (worker.DONE, worker.REFUSED, worker.MESSAGE)
LogCallback = Callable[[str, int, str], None]


class _Groups(NamedTuple):
    """The variables of ports by FMI type, as the worker takes them."""

    order: Indices
    """Places in the ports, in the order of the groups."""
    groups: list[dict[str, Any]]


class RemoteInstance:
    """One instance of one FMU, FMI 2.0 or 3.0, behind the face of an instance."""

    def __init__(
        self,
        name: str,
        path: Path,
        parameters: Mapping[str, Any],
        log: LogCallback,
        model: Model | None = None,
        *,
        limits: FmuLimits,
    ) -> None:
        self.name = name
        self.path = path
        self._names = check_archive(path)
        self._description = read_description(path)
        self.identity = str(self._description.guid)
        self.has_variable_step = has_variable_step(self._description)
        self._version = 3 if str(self._description.fmiVersion).startswith("3") else 2
        self.inputs, self.outputs, self.parameters = (
            ports_of(self._description, causality, model, path) for causality in ("input", "output", "parameter")
        )
        texts = {item.name: item.start for item in text_parameters(self._description)}
        self._texts = {**texts, **{key: str(value) for key, value in parameters.items() if key in texts}}
        """Text parameters, also those that keep their start values: an array is set as a whole."""
        for key, value in parameters.items():
            if key in texts:
                continue
            if key not in self.parameters.index:
                raise RunError(f"{path.name} has no parameter {key}")
            self.parameters.values[self.parameters.index[key]] = float(value)
        self._changed = list(parameters)
        self._log = log
        self._limits = limits
        self._folder: Path | None = None
        self._process: _Process | None = None
        self._is_running = self._is_fresh = False
        self._t_ns = 0
        self._in, self._out = self._groups(self.inputs), self._groups(self.outputs)
        self._wide = self._wide_outputs()
        self._shared: SharedNumbers | None = None
        self._seen = b""

    def initialize(self, stop_ns: int) -> None:
        """Unpack, start the process, load, set the parameters, enter Initialization Mode."""
        identifier = str(self._description.coSimulation.modelIdentifier)
        try:
            library = binary(self._names, identifier, self._version)
        except ValueError as error:
            raise NotRunError(f"{self.path.name} {error}") from None
        self._folder = new_folder("fmu")
        try:
            unpack(self.path, self._folder / "fmu")
        except RESOURCES:
            raise
        except Exception as error:
            raise NotRunError(f"{self.path.name} cannot be unpacked: {excerpt(error)}") from error
        place = self._folder / "fmu" / library
        self._shared = SharedNumbers(self._folder, len(self._in.order), len(self._out.order))
        try:
            self._process = _Process(place.parent, self._folder, self._limits, self._shared.descriptors)
        finally:
            self._shared.close_handle()
        resources = self._folder / "fmu" / "resources"
        asked = {
            "version": self._version,
            "library": str(place),
            "name": self.name,
            "guid": self.identity,
            "shared": self._shared.place,
            "resources": f"{resources}{os.sep}" if self._version == 3 else resources.as_uri(),
            "inputs": self._in.groups,
            "outputs": self._out.groups,
            "memory": self._limits.memory,
        }
        self._ask(worker.LOAD, json.dumps(asked).encode(), "while loading")
        if self._changed:
            self._ask(worker.PARAMETERS, json.dumps(self._settings()).encode(), "at its parameters")
        self._ask(worker.INITIALIZE, json.dumps([stop_ns / 1e9]).encode(), "in initialization")

    def start(self) -> None:
        """Exit Initialization Mode."""
        self._ask(worker.START, b"", "in initialization")
        self._is_running, self._is_fresh = True, False

    def fetch_outputs(self) -> None:
        """Ask for the outputs, unless the last step has brought them. What anything is made of must not be NaN."""
        assert self._shared is not None
        values, shared = self.outputs.values, self._shared
        if not self._is_fresh:
            self._ask(worker.OUTPUTS, b"", f"giving outputs at {self._t_ns / 1e9:g} s")
        values[self._out.order] = shared.outputs
        if len(self._wide):
            self._check_wide()
        if isnan(shared.ones.dot(shared.outputs)):
            names = [self.outputs.names[place] for place in self.outputs.used if isnan(values[place])]
            if names:
                raise RunError(f"{self.name} gives NaN for {', '.join(names)} at {self._t_ns / 1e9:g} s")

    def _wide_outputs(self) -> Indices:
        """Return the places of outputs of types that hold more than the 32-bit integers that are supported."""
        named = {name: str(item.type) for item in self._description.modelVariables for name in element_names(item)}
        wide = WIDE if self._version == 3 else ()
        places = [self.outputs.index[name] for name in self.outputs.names if named.get(name) in wide]
        return np.array(places, dtype=np.intp)

    def _check_wide(self) -> None:
        """Raise ``RunError`` if an output is no 32-bit integer: a log could not hold it."""
        beyond = self._wide[np.abs(self.outputs.values[self._wide]) >= MOST_WHOLE]
        if len(beyond):
            name, value = self.outputs.names[beyond[0]], self.outputs.values[beyond[0]]
            raise RunError(
                f"{self.name} gives {value:.17g} for {name} at {self._t_ns / 1e9:g} s, beyond 32-bit integers"
            )

    def send_inputs(self) -> None:
        """In Initialization Mode, hand over the inputs; later they go with the step."""
        if not self._is_running:
            self._lay_inputs()
            self._ask(worker.INPUTS, b"", "taking inputs at 0 s")

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Hand over the inputs, unless they are what they were: an FMU holds its inputs. Step; take the outputs."""
        assert self._shared is not None
        order = worker.STEP if self._lay_inputs() else worker.HELD_STEP
        worker.TIMES.pack_into(self._shared.memory, 0, t_ns / 1e9, dt_ns / 1e9)
        self._t_ns = t_ns
        self._ask(order, b"", "")
        self._t_ns, self._is_fresh = t_ns + dt_ns, True

    def _lay_inputs(self) -> bool:
        """Lay the inputs where the FMU finds them; return whether any has changed."""
        assert self._shared is not None
        given = self.inputs.values[self._in.order]
        now = given.tobytes()
        if now == self._seen:
            return False
        self._seen = now
        self._shared.inputs[:] = given
        return True

    def close(self) -> None:
        """Have the FMU terminated and freed, and end its process."""
        if self._process is not None:
            process, self._process = self._process, None
            process.close(min(self._limits.step_timeout, 5.0))
        self._shared = None
        if self._folder is not None:
            remove_folder(self._folder)
            self._folder = None

    def _ask(self, order: bytes, data: bytes, when: str) -> None:
        """Wait until an order is done. Raises ``RunError`` if the FMU refuses, crashes, leaves or takes too long."""
        assert self._process is not None
        try:
            self._process.ask(order, data, self._limits.step_timeout, self._on_log_message)
        except _NoAnswerError as error:
            when = when or f"in the step at {self._t_ns / 1e9:g} s"
            made = NotRunError if order == worker.LOAD or error.is_from_outside else RunError
            text = str(error).format(when=when)
            raise made(f"{self.name} {instantiation_message(text) if order == worker.LOAD else text}") from None

    def _on_log_message(self, status: int, text: str) -> None:
        self._log(self.name, status, text)

    def _settings(self) -> list[dict[str, Any]]:
        """Return the parameters that are set, with the values of whole arrays, as groups."""
        values = self.parameters.values
        wanted = set(self._changed)
        groups = []
        for variable in self._description.modelVariables:
            names = element_names(variable) if variable.causality == "parameter" else []
            if wanted & set(names):
                group = self._group(str(variable.type), [(int(variable.valueReference), len(names))])
                of_names = self._texts if names[0] in self._texts else None
                given = [of_names[name] if of_names else float(values[self.parameters.index[name]]) for name in names]
                groups.append({**group, "values": given})
        return groups

    def _groups(self, ports: Ports) -> _Groups:
        own = set(ports.names[: ports.own])
        by_type: dict[str, list[tuple[int, list[int]]]] = {}
        for variable in self._description.modelVariables:
            names = element_names(variable)
            if variable.causality in ("input", "output", "local") and names[0] in own:
                found = int(variable.valueReference), [ports.index[name] for name in names]
                by_type.setdefault(str(variable.type), []).append(found)
        order = [place for items in by_type.values() for _, places in items for place in places]
        groups = [self._group(kind, [(ref, len(places)) for ref, places in by_type[kind]]) for kind in by_type]
        return _Groups(np.array(order, dtype=np.intp), groups)

    def _group(self, kind: str, items: Sequence[tuple[int, int]]) -> dict[str, Any]:
        enumeration = "Int64" if self._version == 3 else "Integer"
        word = {"Enumeration": enumeration, "Boolean": "Boolean3" if self._version == 3 else "Boolean"}.get(kind, kind)
        return {"type": word, "references": [ref for ref, _ in items], "count": sum(count for _, count in items)}


class _NoAnswerError(Exception):
    """Why there is no answer, with ``{when}`` for the place."""

    is_from_outside = False
    """The process was killed, as by the system where memory is short."""


class _Process:
    """A worker, its pipes, and who watches the clock."""

    def __init__(self, folder: Path, room: Path, limits: FmuLimits, inherited: Sequence[int] = ()) -> None:
        wrapper = sandbox_command(room) if limits.is_sandboxed else []
        self._printed = (room / "printed").open("a+b", buffering=0)
        """Read by this handle alone: the FMU may put anything in the place of the file."""
        module = "orchestrator.simulation.imported.worker"
        try:
            self._child = own_process(module, folder, self._printed, wrapper, inherited)
        except BaseException:
            self._printed.close()
            raise
        LIVING.add(self._child)
        assert self._child.stdin is not None
        assert self._child.stdout is not None
        self._pipes = self._child.stdin, self._child.stdout
        self._writing = self._pipes[0].fileno()
        self._answers = worker.Stream(self._pipes[1].fileno(), worker.MAX_ANSWER, self._waiting())
        self._number = secrets.randbits(62)
        self._deadline = float("inf")
        self._left, self._run_timeout = limits.run_timeout, limits.run_timeout
        self._is_late = False
        self._over = threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()

    def ask(self, order: bytes, data: bytes, limit: float, on_message: Callable[[int, str], None]) -> None:
        """Wait until an order is done; messages that come before that go to ``on_message``."""
        begun = time.monotonic()
        self._deadline = begun + min(limit, self._left)
        self._number += 1
        try:
            worker.send(self._writing, order, self._number, data)
            while True:
                letter, number, answer = self._answers.message()
                if number != self._number or letter not in ANSWERS:
                    raise worker.ForeignAnswerError
                if letter == worker.DONE:
                    return
                what, status, text = answer_of(letter, answer)
                if letter == worker.REFUSED:
                    raise _NoAnswerError(f"{what}: {text or 'no message'}".replace("{", "{{").replace("}", "}}"))
                on_message(status, text)
        except (OSError, EOFError):
            raise self._exit_error(limit) from None
        except worker.ForeignAnswerError:
            raise self._interference_error() from None
        finally:
            self._deadline = float("inf")
            self._left -= time.monotonic() - begun

    def close(self, limit: float) -> None:
        """Let the worker end; end it if it does not."""
        self._left = max(self._left, limit)
        with suppress(_NoAnswerError):
            self.ask(worker.CLOSE, b"", limit, lambda status, text: None)
        self._over.set()
        with suppress(OSError):
            self._pipes[0].close()
        try:
            self._child.wait(limit)
        except subprocess.TimeoutExpired:
            end(self._child)
            self._child.wait()
        self._pipes[1].close()
        self._printed.close()
        LIVING.discard(self._child)

    def _waiting(self) -> Callable[[], None]:
        """Return what waits for an answer, or for the end of the time: others may keep the pipe open."""
        if not hasattr(select, "poll"):
            return lambda: None
        answers = select.poll()
        answers.register(self._pipes[1].fileno(), select.POLLIN)

        def wait() -> None:
            while not answers.poll(1000.0 * POLL_INTERVAL):
                if self._is_late:
                    raise EOFError

        return wait

    def _watch(self) -> None:
        while not self._over.wait(POLL_INTERVAL):
            with suppress(OSError, ValueError):  # it may be closed by now
                if os.fstat(self._printed.fileno()).st_size > MAX_PRINTED:
                    self._printed.truncate(0)
            if time.monotonic() > self._deadline:
                self._is_late = True
                end(self._child)
                return

    def _interference_error(self) -> _NoAnswerError:
        end(self._child)
        self._child.wait()
        found = _NoAnswerError("wrote into the pipe of its process {when}, so nothing that it gave can be trusted")
        found.is_from_outside = True
        return found

    def _exit_error(self, limit: float) -> _NoAnswerError:
        try:
            code = self._child.wait(EXIT_TIMEOUT)
        except subprocess.TimeoutExpired:
            end(self._child)
            code = self._child.wait()
            if not self._is_late:
                return _NoAnswerError("closed the pipes of its process {when}")
        if self._is_late:
            if limit > self._left:
                return _NoAnswerError(f"took more than {self._run_timeout:g} s in all {{when}}, so it was ended")
            return _NoAnswerError(f"took more than {limit:g} s {{when}}, so it was ended")
        printed = _last_line(self._printed)
        words = f"; it printed: {printed}".replace("{", "{{").replace("}", "}}") if printed else ""
        if code < 0:
            found = _NoAnswerError(f"crashed {{when}} ({_signal_name(-code)}){words}")
            found.is_from_outside = code == -getattr(signal, "SIGKILL", 0)
            return found
        return _NoAnswerError(f"ended its process {{when}} (exit code {code}){words}")


def answer_of(letter: bytes, answer: bytes) -> tuple[str, int, str]:
    """Return (what was refused, FMI status, text) of an answer. Raises ``ForeignAnswerError`` if it is none."""
    try:
        said = json.loads(answer)
    except (ValueError, RecursionError):
        raise worker.ForeignAnswerError from None
    shape = (str, int, str) if letter == worker.REFUSED else (int, str)
    if not isinstance(said, list) or tuple(map(type, said)) != shape:
        raise worker.ForeignAnswerError
    what, status, text = said if letter == worker.REFUSED else ("", *said)
    if letter == worker.REFUSED:
        what, text = " ".join(what.splitlines()), " ".join(text.splitlines())
    return printable(what), status, printable(text)


def _last_line(file: BinaryIO) -> str:
    """Return the last line that a process printed, as far as people can read it."""
    file.seek(max(0, os.fstat(file.fileno()).st_size - 2000))
    lines = file.read(2000).decode(errors="replace").strip().splitlines()
    return printable(lines[-1][:300]) if lines else ""


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
