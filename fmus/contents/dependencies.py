"""Which parameters an output depends on at the start: all that its model shows, and no input.

``initialize`` has no argument but the parameters. FMI lets a list name more than what acts; one without the inputs
says to an importer that no algebraic loop has to be solved at the start.
"""

from modelkit.model import Model
from modelkit.variables import variables


def initial_dependencies(model: Model) -> dict[str, list[str]]:
    """Return output -> parameters, in the order of the types; those of its own part in a model of several."""
    outputs, parameters = (
        [item.name for item in variables(group) if model.shows(item.name)] for group in (model.outputs, model.params)
    )
    found: dict[str, list[str]] = {}
    for part in [""] if model.assembly is None else [f"{name}." for name, _ in model.assembly.parts]:
        own = [name for name in parameters if name.startswith(part)]
        found |= {name: own for name in outputs if name.startswith(part)}
    return found
