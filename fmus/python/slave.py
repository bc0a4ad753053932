"""The slave inside a PythonFMU: keeps the values, calls the model, never lets an exception out.

The FMI binary of PythonFMU answers an exception with fmi2Fatal, so every method here returns normally. An exception of
the model is logged with its traceback and fmi2DoStep gives fmi2Discard. A wrong call (unknown value reference,
parameter set too late) is logged too; as the binary cannot answer it with fmi2Error, the next fmi2DoStep is refused,
until fmi2Reset or a restored state.
"""

import base64
import json
import math
import traceback
import zlib
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from fmus.python.binary import end_once, keep, pin_thread, tidy_path
from fmus.python.layout import Layout, Values, picker
from modelkit.model import Model
from modelkit.store import bytes_of, store_of
from modelkit.variables import constructor, flatten

INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED = range(4)
FMI_TYPES = {float: "Real", int: "Integer", bool: "Boolean"}
MISSING: dict[type, Any] = {float: math.nan, int: 0, bool: False}
MOST_PICKERS = 256
NS_PER_SECOND = 1e9
CLOCK_TOLERANCE = 1000
"""Between the importer's clock and the FMU's, and of a last step beyond the stop time [ns]."""
MAX_TIME = 4e9
"""Latest time that an importer may name [s]: the same as in the native FMUs."""


class Snapshot(NamedTuple):
    """Everything an instance knows."""

    build: str
    mode: int
    stale: bool
    refused: str
    values: tuple[Any, ...]
    store: bytes
    state: Any


class ModelSlave(Fmi2Slave):  # type: ignore[misc]
    """Base of the slave classes: a subclass names its ``model`` and its ``build``."""

    model: ClassVar[Model]
    build: ClassVar[str]
    """Content hash: a state saved by another build is refused."""
    layout: ClassVar[Layout]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        pin_thread()
        keep(self)
        tidy_path(self.resources)
        end_once(self.resources)
        self.values: Values = list(self.layout.start)
        self.mode = INSTANTIATED
        self.refused = ""
        self.stale = True
        self.params: Any = None
        self.state: Any = None
        self.stop_ns: int | None = None
        """Stop time that the importer defined [ns]; belongs to the experiment, not to a saved state."""
        self.store: Any = None
        """Work arrays, changed in place; None if the model has none."""
        self._step: Callable[..., Any] = self.model.step
        self._pickers: dict[type, dict[tuple[int, ...], Callable[[Values], Values]]] = {float: {}, int: {}, bool: {}}
        self._settable: dict[type, dict[tuple[int, ...], bool]] = {float: {}, int: {}, bool: {}}
        """Sets of references that may be set now, and whether there are parameters among them."""

    # Course of a simulation

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Take the start time, and the stop time if there is one: no step goes beyond it."""
        if not abs(start_time) <= MAX_TIME:
            self._refuse(f"start time {start_time:g} s is no time")
        elif stop_time is not None and not stop_time >= start_time:
            self._refuse(f"stop time {stop_time:g} s is not after start time {start_time:g} s")
        else:
            self.values[self.layout.time] = start_time
            self.stop_ns = None if stop_time is None or stop_time > MAX_TIME else round(stop_time * NS_PER_SECOND)

    def enter_initialization_mode(self) -> None:
        """Make the outputs valid."""
        self.mode = INITIALIZATION
        self._initialize()

    def exit_initialization_mode(self) -> None:
        """Take over the parameters set in Initialization Mode; from now on they are fixed."""
        if self.stale:
            self._initialize()
        self.mode = STEPPING
        self._forget_settable()

    def terminate(self) -> None:
        """Allow no further step."""
        self.mode = TERMINATED

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Move on by ``step_size`` [s] with the inputs held; False (fmi2Discard) leaves everything as it was."""
        try:
            pin_thread()
            if self.mode != STEPPING or self.refused:
                self._error(self.refused or "fmi2DoStep outside of Step Mode")
                return False
            layout, values = self.layout, self.values
            end_time = current_time + step_size
            end_ns = round(end_time * NS_PER_SECOND)
            dt_ns = end_ns - round(current_time * NS_PER_SECOND)
            if not step_size > 0.0:
                self._error(f"communication step of {step_size} s: expected a positive number")
                return False
            if self.stop_ns is not None and end_ns - CLOCK_TOLERANCE > self.stop_ns:
                stop_time = self.stop_ns / NS_PER_SECOND
                self._error(f"fmi2DoStep: the step to {end_time:.9f} s is beyond the stop time {stop_time:.9f} s")
                return False
            if dt_ns <= 0:  # over before the clock's next nanosecond: a master that adds up t += h makes one at the end
                return True
            state, outputs = self._step(self.state, layout.inputs(values), self.params, dt_ns)
            values[layout.first_output : layout.time] = layout.outputs(outputs)
            values[layout.time] = end_time
            self.state = state
        except BaseException:
            self._error(f"fmi2DoStep at {current_time} s failed\n{traceback.format_exc()}")
            return False
        return True

    def _initialize(self) -> None:
        """Compute state and outputs at the start from the parameters."""
        try:
            layout, values = self.layout, self.values
            self.stale = False
            self.params = layout.params(values)
            self._use(self.model.new_store())
            self.state, outputs = self.model.initialize(self.params)
            values[layout.first_output : layout.time] = layout.outputs(outputs)
        except BaseException:
            self._refuse(f"the model's initialize failed\n{traceback.format_exc()}")

    def _use(self, store: Any) -> None:
        """Step with these work arrays from now on."""
        self.store = store
        self._step = self.model.stepper(store)

    # Values

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return Real values."""
        return self._get(float, vrs)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return Integer values."""
        return self._get(int, vrs)

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Return Boolean values."""
        return self._get(bool, vrs)

    def get_string(self, vrs: list[int]) -> list[str]:
        """Refuse: there are no String variables; to ask for none is no mistake."""
        if vrs:
            self._refuse(f"fmi2GetString: value references {vrs} are no String variables")
        return [""] * len(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real parameters or inputs."""
        self._set(float, vrs, values)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer parameters or inputs."""
        self._set(int, vrs, values)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean parameters or inputs."""
        self._set(bool, vrs, values)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Refuse: there are no String variables; to set none is no mistake."""
        if vrs:
            self._refuse(f"fmi2SetString: value references {vrs} are no String variables")

    def _get(self, kind: type, vrs: list[int]) -> list[Any]:
        try:
            if self.stale:
                self._initialize()
            key = tuple(vrs)
            pick = self._pickers[kind].get(key)
            if pick is None:
                wrong = [vr for vr in vrs if not self._has(kind, vr)]
                if wrong:
                    self._refuse(f"fmi2Get{FMI_TYPES[kind]}: no such variable: value references {wrong}")
                    return [self.values[vr] if vr not in wrong else MISSING[kind] for vr in vrs]
                if len(self._pickers[kind]) >= MOST_PICKERS:
                    self._pickers[kind].clear()
                pick = self._pickers[kind][key] = picker(key)
            return pick(self.values)
        except BaseException:
            self._refuse(traceback.format_exc())
            return [MISSING[kind]] * len(vrs)

    def _set(self, kind: type, vrs: list[int], new: Sequence[Any]) -> None:
        try:
            key = tuple(vrs)
            if key not in self._settable[kind] and not self._may_set(kind, key):
                return
            parameters = self._settable[kind][key]
            if parameters and not self._in_range(key, new):
                return
            values = self.values
            for vr, value in zip(key, new, strict=True):
                values[vr] = value
            if parameters and self.mode < STEPPING:
                self.stale = True
            elif parameters:
                self.params = self.layout.params(values)
        except BaseException:
            self._refuse(traceback.format_exc())

    def _has(self, kind: type, vr: int) -> bool:
        return 0 <= vr < len(self.layout.kinds) and self.layout.kinds[vr] is kind

    def _may_set(self, kind: type, key: tuple[int, ...]) -> bool:
        """Return whether all of ``key`` may be set in this mode; remember it, or log what is wrong."""
        layout = self.layout
        free = range(layout.first_output) if self.mode < STEPPING else range(layout.first_input, layout.first_output)
        unknown = [vr for vr in key if not self._has(kind, vr)]
        fixed = [vr for vr in key if vr not in unknown and vr not in free and vr not in layout.tunable]
        if unknown or fixed:
            why = "no such variable" if unknown else "cannot be set now (fixed parameter, or calculated)"
            self._refuse(f"fmi2Set{FMI_TYPES[kind]}: {why}: value references {unknown or fixed}")
            return False
        if len(self._settable[kind]) >= MOST_PICKERS:
            self._settable[kind].clear()
        self._settable[kind][key] = any(vr < layout.first_input for vr in key)
        return True

    def _in_range(self, key: tuple[int, ...], new: Sequence[Any]) -> bool:
        """Return whether all parameters among ``key`` may have their new values; log the first that may not."""
        for vr, value in zip(key, new, strict=True):
            if vr < self.layout.first_input:
                low, high = self.layout.limits[vr]
                if not low <= value <= high:
                    self._refuse(f"value reference {vr}: {value} is not in [{low:g}, {high:g}]")
                    return False
        return True

    def _forget_settable(self) -> None:
        for known in self._settable.values():
            known.clear()

    # State

    def _get_fmu_state(self) -> Snapshot | None:
        """Return everything this instance knows; its parts never change."""
        try:
            if self.stale:
                self._initialize()
            values, store = tuple(self.values), bytes_of(self.store)
            return Snapshot(self.build, self.mode, self.stale, self.refused, values, store, self.state)
        except BaseException:
            self._refuse(traceback.format_exc())
            return None

    def _set_fmu_state(self, state: Any) -> None:
        """Become what ``state`` says; a state of another build is refused."""
        try:
            if not isinstance(state, Snapshot) or state.build != self.build:
                self._refuse("fmi2SetFMUstate: this state was not saved by this FMU")
                return
            self.mode, self.stale, self.refused = state.mode, state.stale, state.refused
            self.values[:] = state.values
            self.params = self.layout.params(self.values)
            self._use(store_of(self.model.store, state.store))
            self.state = state.state
            self._forget_settable()
        except BaseException:
            self._refuse(traceback.format_exc())

    @classmethod
    def _fmu_state_to_bytes(cls, state: Any) -> bytes:
        """Return a state as JSON: floats with all their digits, NaN and infinities too."""
        if not isinstance(state, Snapshot):
            return b"null"
        store = base64.b64encode(zlib.compress(state.store)).decode()
        return json.dumps([*state[:-3], list(state.values), store, flatten(state.state)]).encode()

    @classmethod
    def _fmu_state_from_bytes(cls, content: bytes) -> Snapshot | None:
        """Return the state, or None (refused by fmi2SetFMUstate) if ``content`` is none of this build."""
        try:
            build, mode, stale, refused, values, store, scalars = json.loads(content)
            if build != cls.build:
                return None
            shape, _ = cls.model.initialize(cls.layout.params(values))
            work, own = zlib.decompress(base64.b64decode(store)), constructor(cls.model.state, shape)(scalars)
            return Snapshot(build, mode, stale, refused, tuple(values), work, own)
        except BaseException:
            return None

    # Log

    def log(
        self, msg: str, status: Any = Fmi2Status.ok, category: str | None = None, debug: bool | None = None
    ) -> None:
        """Log a text; it reaches the host as a printf format, so percent signs are doubled."""
        text = msg.encode("utf-8", "replace").decode("utf-8").replace("%", "%%")
        super().log(text, status, category)

    def _error(self, text: str) -> None:
        self.log(text, Fmi2Status.error)

    def _refuse(self, why: str) -> None:
        """Log a wrong call and allow no further step."""
        self.refused = self.refused or f"refused since: {why.splitlines()[0]}"
        self._error(why)
