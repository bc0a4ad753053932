"""Dual-point preview with fuzzy steering and speed on sharp curves (the preview paper)."""

from controller_fmu.interface import SystemInput
from controller_fmu.preview.driving import DrivingState, driving_outputs, driving_sample, driving_start
from controller_fmu.preview.params import PreviewSystem, PreviewSystemParams
from controller_fmu.preview.signals import PreviewOutput
from modelkit.model import SampledSystem

SYSTEM = SampledSystem(
    field="preview",
    choices=PreviewSystem,
    descriptions=("Driving a road by dual-point preview and fuzzy control",),
    state=DrivingState,
    params=PreviewSystemParams,
    inputs=SystemInput,
    reported=PreviewOutput,
    start=driving_start,
    sample=driving_sample,
    outputs=driving_outputs,
)
"""Its row of ``controller_fmu.registry``."""
