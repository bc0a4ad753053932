"""NTBPTcwPT: Guo et al. 2015, "Path tracking control strategy of automatic parking system"."""

from controller_fmu.guo2015 import chart
from controller_fmu.guo2015.outputs import guo_outputs
from controller_fmu.guo2015.params import GuoSystem, GuoSystemParams
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.signals import GuoOutput
from controller_fmu.guo2015.system import GuoState, guo_sample, guo_start
from controller_fmu.interface import ParkingInput
from modelkit.model import Chart, SampledSystem

SYSTEM = SampledSystem(
    field="guo2015",
    choices=GuoSystem,
    descriptions=(
        "Parking by path and point tracking (Guo 2015)",
        "Parking by path tracking (Guo 2015)",
    ),
    state=GuoState,
    params=GuoSystemParams,
    inputs=ParkingInput,
    reported=GuoOutput,
    start=guo_start,
    sample=guo_sample,
    outputs=guo_outputs,
    charts=(Chart("phase", GuoPhase, chart.Guard, chart.TRANSITIONS),),
)
"""Its row of ``controller_fmu.registry``."""
