"""Somebody else's controller: drives case 4 of Guo 2015 in two arcs, knows no target and no path of ours."""

import sys

from modelkit.model import Model
from two_arcs import model

MODEL = Model(
    name="TwoArcs",
    description="Reverses along two arcs of one radius",
    package=sys.modules[__name__],
    state=model.State,
    params=model.Params,
    inputs=model.Input,
    outputs=model.Output,
    initialize=model.initialize,
    step=model.step,
    step_size=0.01,
    stop_time=60.0,
)
