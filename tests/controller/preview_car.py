"""A 3-DOF single-track car driven by the preview system, in process: the reference loop of the preview tests."""

import math
from typing import NamedTuple

from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.signals import PreviewSignals
from controller_fmu.preview.system import PreviewState, preview_step
from modelkit.vocabulary import Pose

MASS, INERTIA, FRONT, REAR, STIFFNESS = 560.0, 1040.0, 1.13, 0.76, 32000.0
ROLLING, DRAG, GRAVITY = 0.015, 0.35, 9.81


class Row(NamedTuple):
    t: float
    speed: float
    angle: float
    force: float
    sideslip: float
    offset: float
    signals: PreviewSignals


def derivative(x: tuple[float, ...], angle: float, force: float) -> tuple[float, ...]:
    heading, vx, vy, r = x[2:]
    slip_front = angle - math.atan2(vy + FRONT * r, vx)
    slip_rear = -math.atan2(vy - REAR * r, vx)
    fy1, fy2 = STIFFNESS * slip_front, STIFFNESS * slip_rear
    resist = ROLLING * MASS * GRAVITY + DRAG * vx * vx
    ax = (force - resist - fy1 * math.sin(angle)) / MASS + vy * r
    ay = (fy1 * math.cos(angle) + fy2) / MASS - vx * r
    turn = (FRONT * fy1 * math.cos(angle) - REAR * fy2) / INERTIA
    return (
        vx * math.cos(heading) - vy * math.sin(heading),
        vx * math.sin(heading) + vy * math.cos(heading),
        r, ax, ay, turn,
    )  # fmt: skip


def integrate(x: tuple[float, ...], angle: float, force: float, dt: float) -> tuple[float, ...]:
    def at(k: tuple[float, ...], h: float) -> tuple[float, ...]:
        return tuple(a + h * b for a, b in zip(x, k, strict=True))

    k1 = derivative(x, angle, force)
    k2 = derivative(at(k1, dt / 2), angle, force)
    k3 = derivative(at(k2, dt / 2), angle, force)
    k4 = derivative(at(k3, dt), angle, force)
    return tuple(a + dt / 6 * (p + 2 * q + 2 * s + u) for a, p, q, s, u in zip(x, k1, k2, k3, k4, strict=True))


def drive(params: PreviewParams, start_speed: float = 7.0, dt: float = 0.01, longest: float = 400.0) -> list[Row]:
    """Return the log of a drive over the whole road."""
    x: tuple[float, ...] = (0.0, 0.0, 0.0, start_speed, 0.0, 0.0)
    state = PreviewState()
    rows = []
    for step in range(int(longest / dt)):
        heading = x[2]
        rear = Pose(
            x[0] - REAR * math.cos(heading),
            x[1] - REAR * math.sin(heading),
            math.atan2(math.sin(heading), math.cos(heading)),
        )
        state, command = preview_step(state, rear, x[3], REAR, params, dt)
        if command.finished:
            break
        offset = road_offset(state, x, params)
        rows.append(
            Row(
                step * dt,
                x[3],
                command.front_wheel_angle,
                command.force,
                math.atan2(x[4], x[3]),
                offset,
                state.signals,
            )
        )
        x = integrate(x, command.front_wheel_angle, command.force, dt)
    return rows


def road_offset(state: PreviewState, x: tuple[float, ...], params: PreviewParams) -> float:
    from controller_fmu.preview.road import lateral_offset, road_at

    return lateral_offset(road_at(params.road, state.s).pose, x[0], x[1])
