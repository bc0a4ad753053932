"""Where to drive from where the car stands: into the slot in reverse, onto its line ahead, or to a better start.

A route is driven as far as its curvature is continuous. At a jump the driver has to stop and the wheel turns at
standstill, after which all is planned again. So a plan is a first path, and the proof that another begins at its end.
"""

import math
from typing import NamedTuple

from controller_fmu.adaptive.curves import (
    NO_ROUTE,
    SteeringLimits,
    arc,
    arc_in,
    bend_of,
    line_in,
    s_curve,
    straight,
    swing_distance,
)
from controller_fmu.adaptive.room import Room, room_along, room_at
from controller_fmu.adaptive.route import Route, drivable, mirror_route, point_at
from modelkit.vocabulary import Pose

SPEEDS = (2.0, 1.6, 1.3, 1.05, 0.85, 0.7, 0.55, 0.42, 0.32, 0.25)
"""Speeds [m/s] that a route is tried for."""
ROUTE_DESIGN_SPEED = 0.8
"""A route for this speed [m/s] needs no longer way to begin with."""
RADII = (1.0, 1.25, 1.6, 2.2, 4.0, 8.0)
"""Tried, over the smallest."""
LEADS = (0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.5, 3.0, 3.5, 4.0)
"""Ways [m] straight back before the first arc."""
STOP_SPACING = 0.08
"""On the first arc places to stop are looked for so far [m] apart."""
MAX_STOP_CANDIDATES = 90
AHEAD = (0.3, 0.6, 1.0, 1.5, 2.0, 2.6, 3.3)
"""Ways [m] driven ahead for a better start."""
TURNS = (0.0, -0.45, 0.45, -0.9, 0.9)
"""Curvature of them, over the largest."""
ALIGNED_OFFSET = 0.015
ALIGNED_HEADING = 0.007
"""What tracking may leave [m], [rad] where it alone is to put the car right."""
MAX_LINE_OFFSET = 0.08
MAX_LINE_HEADING = 0.25
"""Largest offset [m] and heading [rad] from which the car goes ahead along the slot's line if nothing else leads in."""
IN_SLOT_DISTANCE = 0.9
"""A car nearer than this [m] to the slot's line, turned by less than this [rad], is put right ahead of the target."""
MIN_STOP_WINDOW = 0.16
"""A place to stop [m] that can be met by a driver who is not known yet."""


class Demand(NamedTuple):
    """What a route has to bear with."""

    speed: float
    """The driver's [m/s], with a reserve."""
    willing: bool
    """The driver slows down when advised."""
    rest: float
    """Straight way before the end [m]."""
    share: float
    """Where in a place to stop he is to stop."""
    shortest: float
    """Way [m] he drives at least."""


class Plan(NamedTuple):
    """A route, the speed it is for, and the way to a stop on its first arc for a driver who is faster."""

    route: Route = NO_ROUTE
    speed: float = 0.0
    """[m/s]"""
    slower: Route = NO_ROUTE


NO_PLAN = Plan()
ANY_SPEED = 99.0
"""Of a route whose curvature stays as it is [m/s]."""


def plan(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room) -> Plan:
    """Return the plan from standstill at ``pose`` (slot's frame); its route has no direction if there is none."""
    if _is_aligned(pose, abs(pose.x)):
        return plan_straight(pose, demand, room)
    back = plan_back(pose, demand, wheel, room)
    if back.route.direction != 0:
        return back
    if abs(pose.y) < IN_SLOT_DISTANCE and abs(pose.heading) < IN_SLOT_DISTANCE:
        onto = plan_onto(pose, demand, wheel, room)
        if onto.route.direction != 0:
            return onto
    if (
        abs(pose.y) < MAX_LINE_HEADING
        and abs(pose.heading) < MAX_LINE_HEADING
        and farthest(room) - pose.x >= demand.shortest
    ):
        return Plan(straight(Pose(pose.x, 0.0, 0.0), 1, farthest(room) - pose.x), ANY_SPEED)
    ahead = plan_ahead(pose, demand, wheel, room, True)
    if ahead.route.direction != 0:
        return ahead
    halting = plan_halting(pose, demand, wheel, room)
    if halting.route.direction != 0:
        return halting
    return plan_ahead(pose, demand, wheel, room, False)


def plan_straight(pose: Pose, demand: Demand, room: Room) -> Plan:
    """Return the way along the slot's line to the target, or ahead first if the driver cannot be stopped so soon."""
    if abs(pose.x) >= demand.shortest:
        return Plan(straight(Pose(pose.x, 0.0, 0.0), -1 if pose.x > 0.0 else 1, abs(pose.x)), ANY_SPEED)
    ahead = min(max(demand.shortest, demand.shortest + 0.3 - pose.x), farthest(room) - pose.x)
    if ahead < demand.shortest:
        return NO_PLAN
    return Plan(straight(Pose(pose.x, 0.0, 0.0), 1, ahead), ANY_SPEED)


def farthest(room: Room) -> float:
    """Return the largest x [m] to which the car may go ahead in the slot."""
    return room.front.x - 0.5 * room.front.length - room.wheelbase - room.front_overhang - 2.0 * room.margin


def plan_back(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room) -> Plan:
    """Return the plan in reverse to the target: without a stop, else with one on the first arc."""
    moving = _moving(pose, demand, wheel, room)
    if moving.route.direction != 0:
        if demand.willing:
            return moving._replace(slower=_slower(moving.route, demand, wheel, room))
        return moving
    stop = stop_on_arc(pose, 0.0, wheel.radius, demand, wheel, room)
    return Plan(stop, ANY_SPEED)


def plan_halting(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room) -> Plan:
    """Return the plan in reverse on which the wheel turns at standstill only."""
    stop = stop_on_arc(pose, 0.0, wheel.radius, demand._replace(speed=0.0), wheel, room)
    if stop.direction != 0:
        return Plan(stop, ANY_SPEED)
    return Plan(_smooth(pose, 0.0, 0.0, demand, wheel, room), ANY_SPEED)


def _moving(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room) -> Plan:
    """Return the fastest plan in reverse without a stop for a willing driver, else one for his speed."""
    best = NO_PLAN
    for lead in LEADS:
        if best.speed >= ROUTE_DESIGN_SPEED or (best.route.direction != 0 and not demand.willing):
            return best
        if demand.willing:
            for speed in SPEEDS:
                if speed > best.speed:
                    route = _smooth(pose, speed, lead, demand, wheel, room)
                    if route.direction != 0:
                        best = Plan(route, speed)
        else:
            route = _smooth(pose, demand.speed, lead, demand, wheel, room)
            if route.direction != 0:
                best = Plan(route, demand.speed)
    return best


def _smooth(pose: Pose, speed: float, lead: float, demand: Demand, wheel: SteeringLimits, room: Room) -> Route:
    """Return a free route in reverse for ``speed``; with 0 the wheel turns at standstill."""
    enough = _enough(pose, room)
    for mirror in (1.0, -1.0):
        start = Pose(pose.x, mirror * pose.y, mirror * pose.heading)
        if lead == 0.0:
            found = mirror_route(arc_in(start, speed, wheel, demand.rest), mirror, pose, -1)
            if _is_long(found, demand.shortest) and room_along(found, room, enough) >= enough:
                return found
        for share in RADII:
            radius = share * wheel.radius
            bend = bend_of(radius, swing_distance(speed, radius, wheel))
            if lead == 0.0:
                found = mirror_route(line_in(start, bend, demand.rest), mirror, pose, -1)
                if _is_long(found, demand.shortest) and room_along(found, room, enough) >= enough:
                    return found
            for other in RADII:
                radius2 = other * wheel.radius
                bend2 = bend_of(radius2, swing_distance(speed, radius2, wheel))
                found = mirror_route(s_curve(start, lead, bend, bend2, demand.rest), mirror, pose, -1)
                if _is_long(found, demand.shortest) and room_along(found, room, enough) >= enough:
                    return found
    return NO_ROUTE


def stop_on_arc(pose: Pose, lead: float, radius: float, demand: Demand, wheel: SteeringLimits, room: Room) -> Route:
    """Return the first arc back to a stop from which a left arc alone leads in, at the driver's speed."""
    if lead > 0.0:
        return straight(pose, -1, lead)
    for mirror in (1.0, -1.0):
        start = Pose(pose.x, mirror * pose.y, mirror * pose.heading)
        first = -1.0
        last = -1.0
        for number in range(MAX_STOP_CANDIDATES):
            s = STOP_SPACING * number
            at = point_at(arc(start, -1, s, -1.0 / radius), s).pose
            inwards = arc_in(at, demand.speed, wheel, demand.rest)
            free = inwards.direction != 0
            if free:
                found = mirror_route(inwards, mirror, Pose(at.x, mirror * at.y, mirror * at.heading), -1)
                free = room_along(found, room, room.margin) >= room.margin
            if free:
                first = s if first < 0.0 else first
                last = s
            elif first >= 0.0:
                break
        if last - first >= MIN_STOP_WINDOW and last > 0.0:
            s = first + demand.share * (last - first)
            if s >= demand.shortest:
                return arc(pose, -1, s, -mirror / radius)
    return NO_ROUTE


def plan_onto(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room) -> Plan:
    """Return the plan forward onto the slot's line, as far as the neighbour ahead allows."""
    seen = Pose(farthest(room) - pose.x, pose.y, -pose.heading)
    at_once = demand._replace(rest=0.0)
    empty = room._replace(front=room.front._replace(x=1e6), rear=room.rear._replace(x=-1e6), lowest=-1e6, highest=1e6)
    for share in (1.0, 0.6, 0.35, 0.0):
        speed = share * demand.speed
        if share == 1.0 or share == 0.0 or demand.willing:
            found = _smooth(seen, speed, 0.0, at_once, wheel, empty)
            if found.direction != 0:
                route = mirror_route(found, 1.0, pose, 1)
                enough = _enough(pose, room)
                if room_along(route, room, enough) >= enough:
                    return Plan(route, speed if speed > 0.0 else ANY_SPEED)
    return NO_PLAN


def plan_ahead(pose: Pose, demand: Demand, wheel: SteeringLimits, room: Room, moving: bool) -> Plan:
    """Return the shortest way ahead to where the way in reverse can begin; ``moving``: and needs no stop."""
    enough = _enough(pose, room)
    for more in AHEAD:
        s = more + demand.shortest
        for turn in TURNS:
            route = arc(pose, 1, s, turn / wheel.radius)
            if room_along(route, room, enough) >= enough:
                end = point_at(route, s).pose
                back = _moving(end, demand, wheel, room) if moving else plan_halting(end, demand, wheel, room)
                if back.route.direction != 0:
                    return Plan(route, ANY_SPEED)
    return NO_PLAN


def _is_aligned(pose: Pose, s: float) -> bool:
    """Return whether tracking alone puts the car right on the slot's line over ``s`` [m].

    With both gains 1 and 2 the offset obeys y'' = -y - 2 y': y = (y0 + (y0 + y0') s) exp(-s).
    """
    slope = -math.tan(pose.heading) if pose.x > 0.0 else math.tan(pose.heading)
    if abs(pose.y) > MAX_LINE_OFFSET or abs(slope) > MAX_LINE_OFFSET:
        return False
    decay = math.exp(-s)
    both = pose.y + slope
    y = (pose.y + both * s) * decay
    return abs(y) <= ALIGNED_OFFSET and abs(slope - both * s) * decay <= ALIGNED_HEADING


def _slower(route: Route, demand: Demand, wheel: SteeringLimits, room: Room) -> Route:
    """Return the way to a stop for a driver who is too fast for ``route``; no direction if there is none."""
    lead = route.pieces[0]
    if lead.k0 == 0.0 and lead.length > 0.0:
        return straight(route.start, -1, lead.length)
    k = route.pieces[2].k0
    if k == 0.0:
        return NO_ROUTE
    fast = demand._replace(speed=SPEEDS[1])
    radius = abs(1.0 / k)
    stop = stop_on_arc(route.start, 0.0, radius, fast, wheel, room)
    if stop.direction == 0:
        stop = stop_on_arc(route.start, 0.0, radius, demand._replace(speed=0.0), wheel, room)
    return stop


def _enough(pose: Pose, room: Room) -> float:
    """Return the distance [m] to keep: the margin, or nearly what there is where the car stands closer."""
    return min(room.margin, max(0.01, room_at(pose, room) - 0.02))


def _is_long(route: Route, shortest: float) -> bool:
    return route.direction != 0 and drivable(route) >= shortest
