"""Driver-adaptive parking: clothoid paths sized by the driver's speed, predicted stops, planned anew when standing."""

from controller_fmu.adaptive import chart
from controller_fmu.adaptive.outputs import adaptive_outputs
from controller_fmu.adaptive.params import AdaptiveSystem, AdaptiveSystemParams
from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.adaptive.signals import AdaptiveOutput
from controller_fmu.adaptive.system import AdaptiveState, adaptive_sample, adaptive_start
from controller_fmu.interface import ParkingInput
from modelkit.model import Chart, SampledSystem

SYSTEM = SampledSystem(
    field="adaptive",
    choices=AdaptiveSystem,
    descriptions=("Parking adapted to the driver: his speed, his stops",),
    state=AdaptiveState,
    params=AdaptiveSystemParams,
    inputs=ParkingInput,
    reported=AdaptiveOutput,
    start=adaptive_start,
    sample=adaptive_sample,
    outputs=adaptive_outputs,
    charts=(Chart("phase", AdaptivePhase, chart.Guard, chart.TRANSITIONS),),
)
"""Its row of ``controller_fmu.registry``."""
