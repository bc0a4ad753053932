"""From a log to parameters."""

from collections.abc import Sequence

from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.identification.compiled_vehicle import CompiledVehicle
from orchestrator.studies.identification.estimate import estimate
from orchestrator.studies.identification.identifiability import identifiability
from orchestrator.studies.identification.parameter import DRIVE, GEOMETRY, ODOMETRY, STEERING_ACTUATOR, candidate
from orchestrator.studies.identification.playback import WITHOUT_ACTUATOR, WITHOUT_DRIVE
from orchestrator.studies.identification.problem import Problem
from orchestrator.studies.identification.result import Identification
from orchestrator.studies.identification.signals import MeasuredDrive

BODY, KINEMATIC = "body", 0


def identify(
    drive: MeasuredDrive, known: dict[str, float], names: Sequence[str], vehicle: CompiledVehicle | None = None
) -> Identification:
    """Return the parameters ``names`` as a drive identifies them, for example :func:`usual_parameters`.

    ``known``: parameters of the vehicle that differ from the defaults. Raises ``BadInput``.
    """
    if _has_mass(known) and drive.follows_speed:
        text = "a body with mass needs its speed_request in the log; a measured speed is followed by kinematic only"
        raise BadInput(text, key="--set body")
    if not names:
        raise BadInput("all usual parameters are known already; name others: --fit A,B", key="--set")
    problem = Problem(vehicle or CompiledVehicle(), drive, [candidate(name, known) for name in names], known)
    _require_free(problem)
    found = estimate(problem)
    return Identification(problem, found, identifiability(problem, found))


def usual_parameters(drive: MeasuredDrive, known: dict[str, float], given: Sequence[str]) -> list[str]:
    """Return the parameters that this log may identify, without those that are ``given``."""
    names = list(GEOMETRY)
    names += () if drive.follows_steering else STEERING_ACTUATOR
    names += DRIVE if _has_mass(known) else ()
    has_odometry = "odometry" in drive.frames
    if has_odometry or "measured_speed" in drive.followed or {"speed", "measured_speed"} <= drive.compared.keys():
        names.append(ODOMETRY[0])
    if has_odometry or drive.follows_steering:
        names.append(ODOMETRY[1])
    return [name for name in names if name not in given]


def _has_mass(known: dict[str, float]) -> bool:
    return known.get(BODY, KINEMATIC) != KINEMATIC


def _require_free(problem: Problem) -> None:
    """Raise ``BadInput`` for a parameter of an actuator whose requests are not in the log."""
    drive = problem.drive
    without = {
        **(dict.fromkeys(WITHOUT_ACTUATOR, "steering_wheel_request") if drive.follows_steering else {}),
        **(dict.fromkeys(WITHOUT_DRIVE, "speed_request") if drive.follows_speed else {}),
    }
    for item in problem.candidates:
        if item.name in without:
            raise BadInput(
                f"{item.name}: the log has no {without[item.name]}, to which it is the response", key="--fit"
            )
