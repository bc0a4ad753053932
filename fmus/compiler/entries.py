"""The functions by which a model is called from C: start values, initialize, step."""

from collections.abc import Callable
from types import FunctionType
from typing import Any

from fmus.compiler.functions import Instance, instance_of
from fmus.compiler.kinds import INT, Mixed, Struct
from fmus.compiler.names import member_name
from fmus.compiler.program import Program
from fmus.compiler.refusals import CannotError
from modelkit.model import Branch, Branches, Model


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
        self.calls: list[Instance] = []

    def instance(self, function: Callable[..., Any], *kinds: Any) -> Instance:
        """Return the C function for a function of the model."""
        assert isinstance(function, FunctionType)
        made = instance_of(self.program, function, kinds, None)
        self.calls.append(made)
        return made

    def types(self) -> dict[str, str]:
        """Return the names of the four structs."""
        groups = {"params": self.model.params, "inputs": self.model.inputs}
        groups |= {"outputs": self.model.outputs, "state": self.model.state}
        return {group: self.program.type_name(Struct(cls)) for group, cls in groups.items()}

    def heads(self) -> list[str]:
        """Return the declarations of the three functions."""
        types = self.types()
        return [
            f"void {self.name}_defaults({types['params']} *params, {types['inputs']} *inputs)",
            f"void {self.name}_initialize(const {types['params']} *params, {types['state']} *state, "
            f"{types['outputs']} *outputs)",
            f"void {self.name}_step({types['state']} *state, const {types['inputs']} *inputs, "
            f"const {types['params']} *params, int64_t dt_ns, {types['outputs']} *outputs)",
        ]

    def texts(self) -> list[list[str]]:
        """Return the three functions as lines, and those that they are split into before them."""
        model = self.model
        defaults, initialize, step = self.heads()
        params, inputs = (self.program.default(cls) for cls in (model.params, model.inputs))
        found = [["", defaults, "{", f"*params = {params};", f"*inputs = {inputs};", "}"]]
        first = self.instance(model.initialize, Struct(model.params))
        found.append(["", initialize, "{", *self._both(first, ["params"]), "}"])
        if model.branches is None:
            kinds = (Struct(model.state), Struct(model.inputs), Struct(model.params), INT)
            made = self.instance(model.step, *kinds)
            found.append(["", step, "{", *self._both(made, ["state", "inputs", "params", "dt_ns"]), "}"])
            return found
        return found + self._choice(model.branches, step)

    def _both(self, made: Instance, names: list[str]) -> list[str]:
        """Return the lines that call a function which returns state and outputs."""
        given = [
            name if parameter.by_pointer or name == "dt_ns" else f"*{name}"
            for name, parameter in zip(names, made.parameters, strict=True)
        ]
        result = Mixed((Struct(self.model.state), Struct(self.model.outputs)))
        if made.result != result:
            raise CannotError(None, f"{made.name}() does not return state and outputs", "return (state, outputs)")
        declared = self.program.declared(result, "next")
        return [
            f"const {declared} = {made.name}({', '.join(given)});",
            "",
            "*state = next.item0;",
            "*outputs = next.item1;",
        ]

    def _choice(self, branches: Branches, step: str) -> list[list[str]]:
        """Return a step for each system, and the one that chooses among them."""
        found = [self._branch(branches, branch) for branch in branches.systems]
        lines = ["", step, "{", f"switch (params->{member_name(branches.parameter)}) {{"]
        call = "(state, inputs, params, dt_ns, outputs);"
        first, *others = branches.systems
        for branch in others:
            for value in branch.values:
                lines.append(f"case {self.program.number(value).text}:")
            lines += [f"step_{member_name(branch.field)}{call}", "break;"]
        lines += ["default:", f"step_{member_name(first.field)}{call}", "break;", "}", "}"]
        return [*found, lines]

    def _branch(self, branches: Branches, branch: Branch) -> list[str]:
        """Return the step of one system: it reads and writes its own memory only."""
        model = self.model
        fields = self.program.fields(model.state, None)
        own, clock = fields[branch.field], fields[branches.clock]
        params, inputs = Struct(model.params), Struct(model.inputs)
        tick = self.instance(branches.tick, clock, params, INT)
        sample = self.instance(branch.sample, own, inputs, params, INT)
        outputs = self.instance(branch.outputs, own, params)
        refused = self.instance(branches.refused)
        memory = f"state->{member_name(branch.field)}"
        hand = "tick"
        head = self.heads()[2].replace(f"{self.name}_step(", f"step_{member_name(branch.field)}(")
        return [
            "",
            f"static {head}",
            "{",
            f"const {self.program.declared(tick.result, 'ticked')} = {self._called(tick, ['state->' + member_name(branches.clock), '*params', 'dt_ns'])};",  # type: ignore[arg-type]  # noqa: E501
            "",
            f"state->{member_name(branches.clock)} = ticked.item0;",
            "for (int64_t i = 0; i < ticked.item1; ++i) {",
            f"{memory} = {self._called(sample, [memory, '*inputs', '*params', 'ticked.item2'])};",
            "}",
            f"*outputs = state->{member_name(branches.clock)}.usable ? {self._called(outputs, [memory, '*params'])} : "
            f"{refused.name}();",
            "}",
        ][: None if hand else 0]

    def _called(self, made: Instance, places: list[str]) -> str:
        given = []
        for place, parameter in zip(places, made.parameters, strict=True):
            by_pointer = parameter.by_pointer
            given.append((place[1:] if place.startswith("*") else f"&{place}") if by_pointer else place)
        return f"{made.name}({', '.join(given)})"
