"""The controller that carries out a learned policy as a model of its own."""

import sys

from controller_fmu.policy.model import PolicyState, policy_initialize, policy_step
from controller_fmu.policy.params import PolicyParams, PolicySystem
from controller_fmu.policy.signals import PolicyInput, PolicyOutput
from modelkit.model import Model, Variant
from modelkit.terminals import TERMINALS

MODEL = Model(
    name="Controller_policy",
    description="Carries out the actions of a learned policy and tells it what it observes",
    package=sys.modules[__package__.rpartition(".")[0]],
    state=PolicyState,
    params=PolicyParams,
    inputs=PolicyInput,
    outputs=PolicyOutput,
    initialize=policy_initialize,
    step=policy_step,
    step_size=0.01,
    stop_time=5.0,
    terminals=TERMINALS,
    sampled=True,
    view=Variant((("system", int(PolicySystem.POLICY)),), frozenset({"system"})),
)
"""A controller of its own: only a policy needs its observation."""
