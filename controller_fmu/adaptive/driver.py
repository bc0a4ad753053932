"""What the driver has shown: how late he acts on a prompt, how hard he brakes, how fast he drives, whether he obeys.

The way of a stop is v r + v^2 / (2 a). The reaction r is seen when he sets out: prompt to first movement. The
deceleration a is seen while he stops, between 0.8 and 0.3 of the speed he had, and with it when he began to brake,
which is his reaction once more.
"""

import math
from typing import NamedTuple

from controller_fmu.adaptive.params import BeliefParams
from modelkit.maths import clamp

BRAKING_FIT_UPPER_FRACTION = 0.8
BRAKING_FIT_LOWER_FRACTION = 0.3
"""Shares of the speed at the prompt between which the deceleration is measured."""
MIN_STOPPING_SPEED = 0.15
"""A stop from less than this [m/s] teaches nothing."""
REACTION_TIME_MARGIN = 0.05
"""Allowed on top of a reaction seen at setting out only [s]."""
STANDSTILL_SPEED = 0.05
LONG_STOOD = 2.0
"""He stands after this time [s], if he has had time to act on the prompt; after the longer one in any case."""
ACCELERATION_FILTER_TIME = 0.08
"""Time constant of the acceleration [s]."""
NONCOMPLIANCE_SPEED_RATIO = 1.12
"""Beyond this over the advice he does not slow down."""
SLOW_DOWN_SPEED_RATIO = 0.7
"""Advice below this share of his largest speed is one to slow down."""
MAX_STEADY_ACCELERATION = 1.5
STEADY_SPEED_TIME = 1.5
"""The settled speed is a mean over this time [s] of less than ``MAX_STEADY_ACCELERATION`` [m/s2]."""


class Driver(NamedTuple):
    """The driver as he is known."""

    reaction: float = 0.0
    deceleration: float = 0.0
    """0: not known yet."""
    fastest: float = 0.0
    """Largest speed he drove [m/s]."""
    set_out: float = 0.0
    """From the last prompt to go to his first movement [s]."""
    cruise: float = 0.0
    """Speed [m/s] he settles at."""
    obeys: bool = True
    """He has not yet driven faster than advised."""
    slows: bool = False
    """The driver has been seen to slow down when advised."""
    stops: int = 0
    """Stops learnt from."""
    speed: float = 0.0
    acceleration: float = 0.0
    asked_ns: int = 0
    """Since the prompt that he acts on now."""
    moved: bool = False
    """He has set out on the way prompted."""
    stop_speed: float = 0.0
    stop_distance: float = 0.0
    """Driven since the prompt to stop [m]."""
    foreseen: float = 0.0
    """The way of this stop [m] as it was foreseen."""
    stretch: float = 1.0
    """His stops are longer than foreseen by this factor."""
    stood_ns: int = 0
    early_ns: int = 0
    late_ns: int = 0
    """When he had slowed down to ``BRAKING_FIT_UPPER_FRACTION`` and ``BRAKING_FIT_LOWER_FRACTION``; 0: not yet."""


def update_prompt(driver: Driver, speed: float) -> Driver:
    """Return the driver as another advice than before is displayed, at ``speed`` [m/s]."""
    return driver._replace(
        asked_ns=0, moved=abs(speed) > 0.0, stop_speed=abs(speed), stop_distance=0.0, early_ns=0, late_ns=0, stood_ns=0
    )


def on_stop_prompt(driver: Driver, speed: float, advised: float, believed: BeliefParams) -> Driver:
    """Return the driver as a stop is requested at ``speed`` [m/s]: slower since the advice: it is followed."""
    v = abs(speed)
    slows = driver.slows or (
        advised < SLOW_DOWN_SPEED_RATIO * driver.fastest and v <= NONCOMPLIANCE_SPEED_RATIO * advised
    )
    foreseen = stopping_distance(driver, believed)
    return update_prompt(driver, speed)._replace(slows=slows and driver.obeys, foreseen=foreseen)


def update_while_driving(
    driver: Driver, speed: float, advised: float, standstill: float, believed: BeliefParams, dt_ns: int
) -> Driver:
    """Return the driver after a sample in which he was prompted to drive, no faster than ``advised`` [m/s]."""
    v = abs(speed)
    asked_ns = driver.asked_ns + dt_ns
    sets_out = not driver.moved and v > standstill
    reaction = driver.reaction
    if sets_out and driver.stops == 0:
        reaction = clamp(asked_ns * 1e-9, 0.0, 2.0) + REACTION_TIME_MARGIN
    cruise = driver.cruise
    if driver.moved and abs(driver.acceleration) < MAX_STEADY_ACCELERATION:
        cruise = v if cruise == 0.0 else cruise + (v - cruise) * (dt_ns * 1e-9) / STEADY_SPEED_TIME
    late = asked_ns * 1e-9 > reaction_of(driver, believed) + v / deceleration_of(driver, believed)
    return driver._replace(
        reaction=reaction,
        set_out=asked_ns * 1e-9 if sets_out else driver.set_out,
        fastest=max(driver.fastest, v),
        cruise=cruise,
        obeys=driver.obeys and not (late and v > NONCOMPLIANCE_SPEED_RATIO * advised + 0.03),
        speed=v,
        acceleration=_filter_acceleration(driver, v, dt_ns),
        asked_ns=asked_ns,
        moved=driver.moved or sets_out,
    )


def update_while_stopping(driver: Driver, speed: float, standstill: float, dt_ns: int) -> Driver:
    """Return the driver after a sample in which he was prompted to stop."""
    v = abs(speed)
    asked_ns = driver.asked_ns + dt_ns
    return driver._replace(
        speed=v,
        acceleration=_filter_acceleration(driver, v, dt_ns),
        fastest=max(driver.fastest, v),
        asked_ns=asked_ns,
        stop_distance=driver.stop_distance + v * (dt_ns * 1e-9),
        stood_ns=driver.stood_ns + dt_ns if v <= standstill else 0,
        early_ns=asked_ns
        if driver.early_ns == 0 and v < BRAKING_FIT_UPPER_FRACTION * driver.stop_speed
        else driver.early_ns,
        late_ns=asked_ns
        if driver.late_ns == 0 and v < BRAKING_FIT_LOWER_FRACTION * driver.stop_speed
        else driver.late_ns,
    )


def has_stopped(driver: Driver, believed: BeliefParams) -> bool:
    """Return whether he stands because a stop was requested; a crawling driver may stand briefly before he reacts."""
    stood = driver.stood_ns * 1e-9
    late = max(driver.set_out, reaction_of(driver, believed))
    return stood >= STANDSTILL_SPEED and (driver.asked_ns * 1e-9 >= late or stood >= LONG_STOOD)


def update_at_standstill(driver: Driver, believed: BeliefParams) -> Driver:
    """Return the driver who has come to stand after a prompt to stop."""
    v = driver.stop_speed
    took = (driver.late_ns - driver.early_ns) * 1e-9
    still = driver._replace(speed=0.0, acceleration=0.0)
    if v < MIN_STOPPING_SPEED or took <= 0.0:
        return still
    deceleration = clamp((BRAKING_FIT_UPPER_FRACTION - BRAKING_FIT_LOWER_FRACTION) * v / took, 0.5, 15.0)
    reaction = clamp(driver.early_ns * 1e-9 - (1.0 - BRAKING_FIT_UPPER_FRACTION) * v / deceleration, 0.0, 2.0)
    if driver.stops > 0 or driver.reaction > 0.0:
        known = driver.reaction - (REACTION_TIME_MARGIN if driver.stops == 0 else 0.0)
        reaction = 0.5 * (known + clamp(reaction, known - 0.3, known + 0.3))
    stretch = driver.stretch
    if driver.stops > 0 and driver.foreseen > 0.0:
        stretch = clamp(stretch * math.sqrt(driver.stop_distance / driver.foreseen), 0.8, 1.5)
    return still._replace(reaction=reaction, deceleration=deceleration, stops=driver.stops + 1, stretch=stretch)


def reaction_of(driver: Driver, believed: BeliefParams) -> float:
    """Return his reaction [s], as seen or as believed."""
    return driver.reaction if driver.reaction > 0.0 else believed.reaction


def deceleration_of(driver: Driver, believed: BeliefParams) -> float:
    """Return his deceleration [m/s2], as seen or as believed."""
    return driver.deceleration if driver.deceleration > 0.0 else believed.deceleration


def stopping_distance(driver: Driver, believed: BeliefParams) -> float:
    """Return the way [m] he will drive on if a stop is requested now, his speed changing as it does.

    Who drives faster than advised is taken to come back to the speed he settles at: he only swings.
    """
    r = reaction_of(driver, believed)
    most = max(driver.speed, driver.cruise) if driver.cruise > 0.0 else driver.speed + 2.0 * r
    least = 0.0 if driver.obeys else min(driver.speed, driver.cruise)
    braking = clamp(driver.speed + clamp(driver.acceleration, -1.0, 15.0) * r, least, most)
    way = 0.5 * (driver.speed + braking) * r + 0.5 * braking * braking / deceleration_of(driver, believed)
    return driver.stretch * way


def shortest_drive(driver: Driver, believed: BeliefParams) -> float:
    """Return the shortest way [m] he can be made to drive: a stop is requested as soon as he has set out."""
    v = driver.cruise
    return driver.stretch * v * (reaction_of(driver, believed) + 0.5 * v / deceleration_of(driver, believed))


def _filter_acceleration(driver: Driver, v: float, dt_ns: int) -> float:
    dt = dt_ns * 1e-9
    return driver.acceleration + ((v - driver.speed) / dt - driver.acceleration) * dt / (dt + ACCELERATION_FILTER_TIME)
