"""The functions by which a model is called from C: start values, initialize, step."""

from collections.abc import Callable
from types import FunctionType
from typing import Any

from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import BOOL, INT, Array, Kind, Mixed, Struct, describe
from fmus.compiler.target.functions import Instance, instance_of
from fmus.compiler.target.members import members
from fmus.compiler.target.names import member_name
from fmus.compiler.target.program import Program
from fmus.compiler.target.values import Place
from modelkit.model import Model, SampledSystem, SampledSystems
from modelkit.variables import flatten

NAMES = (
    *("params", "inputs", "outputs", "state", "store", "dt_ns", "next", "clock", "samples", "period_ns", "i"),
    *("pass_on", "left_ns", "span_ns", "both", "between"),
)
"""What is called so inside the entries, and no function of a model therefore."""


def roots(model: Model) -> list[FunctionType]:
    """Return the Python functions that a model is entered by."""
    found: list[Callable[..., Any]] = []
    if model.assembly is not None:
        return [function for _, part in model.assembly.parts for function in roots(part)]
    if model.systems is None:
        found += [model.initialize, model.step]
    elif model.store is not None:
        raise CannotError(None, f"the store of {model.name}, which has systems", "give it a step of its own")
    else:
        found += [model.systems.begin, model.systems.tick, model.systems.refused]
        found += [function for item in model.systems.systems for function in (item.start, item.sample, item.outputs)]
    for function in found:
        if not isinstance(function, FunctionType):
            raise CannotError(None, f"{function!r} as a function of the model", "write a function with def")
    return [function for function in found if isinstance(function, FunctionType)]


class Entries:
    """The three functions of a model and what they call."""

    def __init__(self, program: Program, model: Model) -> None:
        self.program, self.model, self.name = program, model, model.name

    def instance(self, function: Callable[..., Any], result: Kind, *kinds: Kind) -> Instance:
        """Return the C function for a function of the model, which must give ``result``."""
        assert isinstance(function, FunctionType)
        made = instance_of(self.program, function, kinds, None)
        if made.result != result:
            what = f"{function.__name__}() does not return {describe(result)}"
            self.program.refuse(function.__module__, made.node, what, "return what the model's types say")
        return made

    def types(self) -> dict[str, str]:
        """Return the names of the structs that an instance is made of."""
        groups = {"params": self.model.params, "inputs": self.model.inputs}
        groups |= {"outputs": self.model.outputs, "state": self.model.state}
        groups |= {} if self.model.store is None else {"store": self.model.store}
        return {group: self.program.type_name(Struct(cls)) for group, cls in groups.items()}

    def heads(self) -> list[str]:
        """Return the declarations of the three functions."""
        types = self.types()
        params, inputs, outputs, state, *stores = (f"{types[group]} *{group}" for group in types)
        store = "".join(f"{item}, " for item in stores)
        return [
            f"void {self.name}_defaults({params}, {inputs})",
            f"void {self.name}_initialize(const {params}, {state}, {outputs})",
            f"void {self.name}_step({store}{state}, const {inputs}, const {params}, int64_t dt_ns, {outputs})",
        ]

    def texts(self) -> list[list[str]]:
        """Return the three functions as lines, and those that they are split into before them."""
        model = self.model
        state, inputs, params = (Struct(cls) for cls in (model.state, model.inputs, model.params))
        outputs = Struct(model.outputs)
        result = Array(state, 2) if state == outputs else Mixed((state, outputs))
        defaults, initialize, step = self.heads()
        starts = [f"*{group} = {self.program.default(getattr(model, group))};" for group in ("params", "inputs")]
        found = [[defaults, "{", *starts, *self._preset(), "}"]]
        if model.systems is not None:
            return [*found, *self._systems(model.systems, initialize, step)]
        first = self.instance(model.initialize, result, params)
        found.append([initialize, "{", *self._result_call(first, ["params"]), "}"])
        stores = [] if model.store is None else ["store"]
        made = self.instance(model.step, result, *(Struct(model.store) for _ in stores), state, inputs, params, INT)
        given = [*stores, "state", "inputs", "params", "dt_ns"]
        if state == outputs:
            return [*found, [step, "{", *self._result_call(made, given), "}"]]
        return [*found, [step, "{", *self._update_call(made, state, "state", given, "outputs"), "}"]]

    def _result_call(self, made: Instance, given: list[str]) -> list[str]:
        """Return the call of a function that gives state and outputs, which may be of one type."""
        if not isinstance(made.result, Array):
            return [_call(made, given, "state", "outputs")]
        both = f"{self.program.declaration(made.result, 'both')};"
        return [both, "", _call(made, given, "both"), "*state = both[0];", "*outputs = both[1];"]

    def _update_call(self, made: Instance, kind: Kind, place: str, given: list[str], *results: str) -> list[str]:
        """Return the call of a function that gives what ``place`` points to anew."""
        if made.changed is not None:
            return [_call(made, given, place, *results)]
        called = _call(made, given, "&next", *results)
        return [f"{self.program.declaration(kind, 'next')};", "", called, f"{_dereference(place)} = next;"]

    def _preset(self) -> list[str]:
        """Return the lines that set the parameters which start with another value than their default."""
        pairs = zip(members(self.model, ("params",)), flatten(self.model.first_params()), strict=True)
        values = dict(self.model.view.starts)
        found = {item.path.removeprefix("params."): value for item, value in pairs if item.name in values}
        return [f"params->{path} = {self.program.number(value).text};" for path, value in found.items()]

    def _systems(self, systems: SampledSystems, initialize: str, step: str) -> list[list[str]]:
        """Return initialize, a step for each system, and the one that chooses among them."""
        found = [self._initialize(systems, initialize)]
        found += [self._system(systems, item, step) for item in systems.systems]
        choice = self._choice(
            systems, lambda item: [f"step_{member_name(item.field)}(state, inputs, params, dt_ns, outputs);"]
        )
        return [
            *found,
            [step, "{", *choice, "default: {", *self._tick(systems), *self._refuse(systems), "break;", "}", "}", "}"],
        ]

    def _tick(self, systems: SampledSystems) -> list[str]:
        """Return what moves the clock on and says how many samples are due."""
        clock = self.program.fields(self.model.state, None)[systems.clock]
        assert isinstance(clock, Struct)
        if self.program.fields(clock.cls, None).get("usable") != BOOL:
            raise CannotError(None, f"a clock without usable: {clock.cls.__name__}", "give it usable: bool")
        tick = self.instance(systems.tick, Mixed((clock, INT, INT)), clock, Struct(self.model.params), INT)
        time = f"state->{member_name(systems.clock)}"
        return [
            f"{self.program.declaration(clock, 'clock')};",
            "int64_t samples;",
            "int64_t period_ns;",
            "",
            _call(tick, [f"&{time}", "params", "dt_ns"], "&clock", "&samples", "&period_ns"),
            f"{time} = clock;",
        ]

    def _refuse(self, systems: SampledSystems) -> list[str]:
        """Return what puts out that no system acts."""
        return [_call(self.instance(systems.refused, Struct(self.model.outputs)), [], "outputs")]

    def _initialize(self, systems: SampledSystems, head: str) -> list[str]:
        """Return initialize: the clock and the memory of every system as they start, the outputs of the chosen one."""
        params, outputs = Struct(self.model.params), Struct(self.model.outputs)
        fields = self.program.fields(self.model.state, None)
        clock = f"state->{member_name(systems.clock)}"
        begin = self.instance(systems.begin, fields[systems.clock], params)
        refused = self._refuse(systems)
        lines = [head, "{", _call(begin, ["params"], f"&{clock}")]
        for item in systems.systems:
            start = self.instance(item.start, fields[item.field], params)
            lines.append(_call(start, ["params"], f"&state->{member_name(item.field)}"))
        lines += [f"if (!{clock}.usable) {{", *refused, "return;", "}"]

        def outputs_of(item: SampledSystem) -> list[str]:
            ready = self.instance(item.outputs, outputs, fields[item.field], params)
            return [_call(ready, [f"&state->{member_name(item.field)}", "params"], "outputs")]

        return [*lines, *self._choice(systems, outputs_of), "default:", *refused, "break;", "}", "}"]

    def _choice(self, systems: SampledSystems, act: Callable[[SampledSystem], list[str]]) -> list[str]:
        """Return the head of a switch over the choosing parameter, with what ``act`` gives for each system."""
        lines = [f"switch (params->{member_name(systems.parameter)}) {{"]
        for item in systems.systems:
            lines += [f"case {self.program.number(value).text}:" for value in item.values]
            lines += [*act(item), "break;"]
        return lines

    def _system(self, systems: SampledSystems, item: SampledSystem, step: str) -> list[str]:
        """Return the step of one system: it reads and writes its own memory only."""
        own = self.program.fields(self.model.state, None)[item.field]
        params, inputs, outputs = Struct(self.model.params), Struct(self.model.inputs), Struct(self.model.outputs)
        sample = self.instance(item.sample, own, own, inputs, params, INT)
        ready = self.instance(item.outputs, outputs, own, params)
        memory = f"state->{member_name(item.field)}"
        return [
            "static " + step.replace(f"{self.name}_step(", f"step_{member_name(item.field)}("),
            "{",
            *self._tick(systems),
            "for (int64_t i = 0; i < samples; ++i) {",
            *self._update_call(sample, own, f"&{memory}", [f"&{memory}", "inputs", "params", "period_ns"]),
            "}",
            "if (clock.usable) {",
            _call(ready, [f"&{memory}", "params"], "outputs"),
            "} else {",
            *self._refuse(systems),
            "}",
            "}",
        ]


def _call(made: Instance, given: list[str], *results: str) -> str:
    """Return the call of a function for pointers to its arguments, its results written to pointers."""
    pairs = zip(given, made.parameters, strict=True)
    texts = [text if parameter.by_pointer or text in ("dt_ns", "period_ns") else _dereference(text)
             for text, parameter in pairs]  # fmt: skip
    if made.changed is not None:
        results = (*results[: made.changed.result], *results[made.changed.result + 1 :])
    if made.outs or made.changed is not None:
        return f"{made.name}({', '.join([*texts, *results])});"
    return f"{_dereference(results[0])} = {made.name}({', '.join(texts)});"


def _dereference(address: str) -> str:
    return address[1:] if address.startswith("&") else Place(address, pointer=True).whole
