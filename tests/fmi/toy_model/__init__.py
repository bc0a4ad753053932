"""A small model of every kind of variable, for the tests of the FMU makers."""

import sys

from modelkit.model import Model
from toy_model import model

MODEL = Model(
    name="Toy",
    description="Two oscillators, a counter and a mode",
    package=sys.modules[__name__],
    state=model.State,
    params=model.Params,
    inputs=model.Input,
    outputs=model.Output,
    initialize=model.initialize,
    step=model.step,
    step_size=0.01,
    stop_time=2.0,
)
