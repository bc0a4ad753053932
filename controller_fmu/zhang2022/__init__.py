"""Quintic path, model predictive steering, PID speed (Zhang 2022)."""

from controller_fmu.interface import ParkingInput
from controller_fmu.zhang2022.outputs import zhang_outputs
from controller_fmu.zhang2022.params import ZhangSystem, ZhangSystemParams
from controller_fmu.zhang2022.signals import ZhangOutput
from controller_fmu.zhang2022.system import ZhangState, zhang_sample, zhang_start
from modelkit.model import SampledSystem

SYSTEM = SampledSystem(
    field="zhang2022",
    choices=ZhangSystem,
    descriptions=("Parking on a quintic path, MPC, PID (Zhang 2022)",),
    state=ZhangState,
    params=ZhangSystemParams,
    inputs=ParkingInput,
    reported=ZhangOutput,
    start=zhang_start,
    sample=zhang_sample,
    outputs=zhang_outputs,
)
"""Its row of ``controller_fmu.registry``."""
