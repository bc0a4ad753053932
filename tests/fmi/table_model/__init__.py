"""A model with a table of two dimensions and rows of modes and truth values, for the arrays of FMI 3.0."""

import sys

from modelkit.model import Model
from table_model import model

MODEL = Model(
    name="Table",
    description="Two rows of three cells",
    package=sys.modules[__name__],
    state=model.State,
    params=model.Params,
    inputs=model.Input,
    outputs=model.Output,
    initialize=model.initialize,
    step=model.step,
    step_size=0.1,
    stop_time=1.0,
)
