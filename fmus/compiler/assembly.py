"""The entries of a model that is several: its functions call theirs, and hand on their outputs."""

from collections.abc import Iterator

from fmus.compiler.entries import Entries
from fmus.compiler.source.types import Struct
from fmus.compiler.target.members import member_path
from fmus.compiler.target.names import member_name
from fmus.compiler.target.program import Program
from modelkit.assembly import BEHIND, INPUTS, LEFT, is_integrated, open_inputs, wires
from modelkit.model import Assembly, Model
from modelkit.variables import variables


class AssemblyEntries(Entries):
    """The three functions of a model that is several, those of its parts before them; see ``modelkit.assembly``."""

    def __init__(self, program: Program, model: Model, assembly: Assembly) -> None:
        super().__init__(program, model)
        self.assembly = assembly
        self.left = f"state->{member_name(LEFT)}"

    def texts(self) -> list[list[str]]:
        """Return all functions as lines."""
        found = []
        for _, part in self.assembly.parts:
            entries = Entries(self.program, part)
            for lines in entries.texts():
                found.append([lines[0] if lines[0].startswith("static ") else f"static {lines[0]}", *lines[1:]])
        defaults, initialize, step = self.heads()
        return [
            *found,
            [self._pass_on_head(), "{", *self._pass_on(), "}"],
            [defaults, "{", *self._calls("defaults", "&params->{0}", "&inputs->{0}"), *self._preset(), "}"],
            [initialize, "{", *self._initialize_all(), "}"],
            [step, "{", *self._step_all(), "}"],
        ]

    def _pass_on_head(self) -> str:
        types = self.types()
        return f"static void pass_on({types['state']} *state, const {types['outputs']} *outputs)"

    def _pass_on(self) -> Iterator[str]:
        """Yield what writes every output to the inputs it feeds, and begins the time to the next exchange."""
        for wire in wires(self.assembly):
            (source, sender), (target, receiver) = self.assembly.parts[wire.source], self.assembly.parts[wire.target]
            reported = member_path(source, variables(sender.outputs)[wire.output].name)
            given = member_path(f"{target}{INPUTS}", variables(receiver.inputs)[wire.input].name)
            yield f"state->{given} = outputs->{reported};"
        yield f"{self.left} = {self.assembly.period_ns};"

    def _initialize_all(self) -> Iterator[str]:
        yield from self._calls("initialize", "&params->{0}", "&state->{0}", "&outputs->{0}")
        for part, model in self.assembly.parts:
            yield f"state->{part}{INPUTS} = {self.program.default(model.inputs)};"
            if is_integrated(model):
                yield f"state->{part}{BEHIND} = 0;"
        yield "pass_on(state, outputs);"

    def _step_all(self) -> Iterator[str]:
        yield "int64_t left_ns = dt_ns;"
        yield ""
        open_ones = list(open_inputs(self.assembly))
        for target, (part, model) in enumerate(self.assembly.parts):
            names = [variables(model.inputs)[place].name for owner, place in open_ones if owner == target]
            if is_integrated(model) and names:
                yield from self._catch_up(part, model, names)
        for target, place in open_ones:
            part, model = self.assembly.parts[target]
            name = variables(model.inputs)[place].name
            yield f"state->{member_path(f'{part}{INPUTS}', name)} = inputs->{member_path(part, name)};"
        if not open_ones:
            yield "(void)inputs;"
        yield "do {"
        yield f"const int64_t span_ns = left_ns < {self.left} ? left_ns : {self.left};"
        yield ""
        for part, model in self.assembly.parts:
            if is_integrated(model):
                yield from self._integrate(part, model)
            else:
                yield self._step(part, model, f"&state->{part}", "span_ns")
        yield f"{self.left} -= span_ns;"
        yield "left_ns -= span_ns;"
        yield f"if ({self.left} == 0) {{"
        yield "pass_on(state, outputs);"
        yield "}"
        yield "} while (left_ns > 0);"

    def _catch_up(self, part: str, model: Model, names: list[str]) -> Iterator[str]:
        """Yield what brings the memory of a part up to date if one of its inputs ``names`` changes."""
        pairs = ((member_path(part, name), member_path(f"{part}{INPUTS}", name)) for name in names)
        changes = " || ".join(f"inputs->{given} != state->{held}" for given, held in pairs)
        yield f"if (state->{part}{BEHIND} > 0 && ({changes})) {{"
        yield self._step(part, model, f"&state->{part}", f"state->{part}{BEHIND}")
        yield f"state->{part}{BEHIND} = 0;"
        yield "}"

    def _integrate(self, part: str, model: Model) -> Iterator[str]:
        """Yield the step of a continuous part: to the exchange from where its memory is, before it with a copy."""
        yield f"if (span_ns < {self.left}) {{"
        yield f"{self.program.declaration(Struct(model.state), 'between')} = state->{part};"
        yield ""
        yield f"state->{part}{BEHIND} += span_ns;"
        yield self._step(part, model, "&between", f"state->{part}{BEHIND}")
        yield "} else {"
        yield self._step(part, model, f"&state->{part}", f"state->{part}{BEHIND} + span_ns")
        yield f"state->{part}{BEHIND} = 0;"
        yield "}"

    def _step(self, part: str, model: Model, memory: str, dt_ns: str) -> str:
        """Return the call of a part's step."""
        store = "" if model.store is None else "store, "
        arguments = f"{memory}, &state->{part}{INPUTS}, &params->{part}, {dt_ns}, &outputs->{part}"
        return f"{model.name}_step({store}{arguments});"

    def _calls(self, function: str, *arguments: str) -> Iterator[str]:
        """Yield the call of a function of each part."""
        for part, model in self.assembly.parts:
            yield f"{model.name}_{function}({', '.join(arguments).format(part)});"
