"""Human-simulated intelligent control: key points, characteristic states, production rules (the HSIC paper)."""

from controller_fmu.hsic.outputs import hsic_outputs
from controller_fmu.hsic.params import HsicSystem, HsicSystemParams
from controller_fmu.hsic.signals import HsicOutput
from controller_fmu.hsic.system import HsicState, hsic_sample, hsic_start
from controller_fmu.interface import ParkingInput
from modelkit.model import SampledSystem

SYSTEM = SampledSystem(
    field="hsic",
    choices=HsicSystem,
    descriptions=("Parking by human-simulated intelligent control",),
    state=HsicState,
    params=HsicSystemParams,
    inputs=ParkingInput,
    reported=HsicOutput,
    start=hsic_start,
    sample=hsic_sample,
    outputs=hsic_outputs,
)
"""Its row of ``controller_fmu.registry``."""
