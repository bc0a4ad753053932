"""The functions by which a model is called from C: start values, initialize, step."""

from collections.abc import Callable
from types import FunctionType
from typing import Any

from fmus.compiler.functions import Instance, instance_of
from fmus.compiler.kinds import BOOL, INT, Kind, Mixed, Struct, described
from fmus.compiler.names import member_name
from fmus.compiler.program import Program
from fmus.compiler.refusals import CannotError
from fmus.compiler.values import Place
from modelkit.model import Branch, Branches, Model

NAMES = ("params", "inputs", "outputs", "state", "dt_ns", "next", "clock", "samples", "period_ns", "i")
"""What is called so inside the entries, and no function of a model therefore."""


def roots(model: Model) -> list[FunctionType]:
    """Return the Python functions that a model is entered by."""
    found: list[Callable[..., Any]] = [model.initialize]
    if model.branches is None:
        found.append(model.step)
    else:
        found += [model.branches.tick, model.branches.refused]
        found += [function for branch in model.branches.systems for function in (branch.sample, branch.outputs)]
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
            what = f"{function.__name__}() does not return {described(result)}"
            self.program.refuse(function.__module__, made.node, what, "return what the model's types say")
        return made

    def types(self) -> dict[str, str]:
        """Return the names of the four structs."""
        groups = {"params": self.model.params, "inputs": self.model.inputs}
        groups |= {"outputs": self.model.outputs, "state": self.model.state}
        return {group: self.program.type_name(Struct(cls)) for group, cls in groups.items()}

    def heads(self) -> list[str]:
        """Return the declarations of the three functions."""
        types = self.types()
        params, inputs, outputs, state = (f"{types[group]} *{group}" for group in types)
        return [
            f"void {self.name}_defaults({params}, {inputs})",
            f"void {self.name}_initialize(const {params}, {state}, {outputs})",
            f"void {self.name}_step({state}, const {inputs}, const {params}, int64_t dt_ns, {outputs})",
        ]

    def texts(self) -> list[list[str]]:
        """Return the three functions as lines, and those that they are split into before them."""
        model = self.model
        state, inputs, params = (Struct(cls) for cls in (model.state, model.inputs, model.params))
        result = Mixed((state, Struct(model.outputs)))
        defaults, initialize, step = self.heads()
        starts = [f"*{group} = {self.program.default(getattr(model, group))};" for group in ("params", "inputs")]
        first = self.instance(model.initialize, result, params)
        found = [[defaults, "{", *starts, "}"], [initialize, "{", _called(first, ["params"], "state", "outputs"), "}"]]
        if model.branches is not None:
            return found + self._choice(model.branches, step)
        made = self.instance(model.step, result, state, inputs, params, INT)
        call = _called(made, ["state", "inputs", "params", "dt_ns"], "&next", "outputs")
        return [*found, [step, "{", f"{self.types()['state']} next;", "", call, "*state = next;", "}"]]

    def _choice(self, branches: Branches, step: str) -> list[list[str]]:
        """Return a step for each system, and the one that chooses among them."""
        found = [self._branch(branches, branch, step) for branch in branches.systems]
        call = "(state, inputs, params, dt_ns, outputs);"
        lines = [step, "{", f"switch (params->{member_name(branches.parameter)}) {{"]
        first, *others = branches.systems
        for branch in others:
            lines += [f"case {self.program.number(value).text}:" for value in branch.values]
            lines += [f"step_{member_name(branch.field)}{call}", "break;"]
        lines += ["default:", f"step_{member_name(first.field)}{call}", "break;", "}", "}"]
        return [*found, lines]

    def _branch(self, branches: Branches, branch: Branch, step: str) -> list[str]:
        """Return the step of one system: it reads and writes its own memory only."""
        model = self.model
        fields = self.program.fields(model.state, None)
        own, clock = fields[branch.field], fields[branches.clock]
        params, inputs, outputs = Struct(model.params), Struct(model.inputs), Struct(model.outputs)
        assert isinstance(clock, Struct)
        if self.program.fields(clock.cls, None).get("usable") != BOOL:
            raise CannotError(None, f"a clock without usable: {clock.cls.__name__}", "give it usable: bool")
        tick = self.instance(branches.tick, Mixed((clock, INT, INT)), clock, params, INT)
        sample = self.instance(branch.sample, own, own, inputs, params, INT)
        ready = self.instance(branch.outputs, outputs, own, params)
        refused = self.instance(branches.refused, outputs)
        memory, time = f"&state->{member_name(branch.field)}", f"state->{member_name(branches.clock)}"
        given = [memory, "inputs", "params", "period_ns"]
        return [
            "static " + step.replace(f"{self.name}_step(", f"step_{member_name(branch.field)}("),
            "{",
            f"{self.program.declared(clock, 'clock')};",
            "int64_t samples;",
            "int64_t period_ns;",
            "",
            _called(tick, [f"&{time}", "params", "dt_ns"], "&clock", "&samples", "&period_ns"),
            f"{time} = clock;",
            "for (int64_t i = 0; i < samples; ++i) {",
            f"{self.program.declared(own, 'next')};",
            "",
            _called(sample, given, "&next"),
            f"state->{member_name(branch.field)} = next;",
            "}",
            "if (clock.usable) {",
            _called(ready, [memory, "params"], "outputs"),
            "} else {",
            _called(refused, [], "outputs"),
            "}",
            "}",
        ]


def _called(made: Instance, given: list[str], *results: str) -> str:
    """Return the call of a function for pointers to its arguments, its results written to pointers."""
    pairs = zip(given, made.parameters, strict=True)
    texts = [text if parameter.by_pointer or text in ("dt_ns", "period_ns") else _pointed(text)
             for text, parameter in pairs]  # fmt: skip
    if made.outs:
        return f"{made.name}({', '.join([*texts, *results])});"
    return f"{_pointed(results[0])} = {made.name}({', '.join(texts)});"


def _pointed(address: str) -> str:
    return address[1:] if address.startswith("&") else Place(address, pointer=True).whole
