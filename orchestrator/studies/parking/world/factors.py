"""What differs from run to run in the world, and by how much. Angles in degrees, as people say them."""

from orchestrator.studies.sweep.study.space import Factor

SLOT = (
    Factor("car", "1", 0, 0, 2, "which car", ("small", "large", "middle")),
    Factor("kind", "1", 0, 0, 1, "how the car shall stand", ("parallel", "perpendicular")),
    Factor("side", "1", 0, 0, 1, "of the road", ("right", "left")),
    Factor("extra", "m", 0.0, 1.0, 2.0, "length (width) of the slot over ISO 16787's shortest for the car"),
    Factor(
        "behind", "1", 0, 0, 2, "what ends the slot: a kerb is a wheel stop across the road", ("none", "wall", "kerb")
    ),
    Factor("depth", "m", 0.0, 0.5, 1.5, "of the slot over ISO 16787's for the car: width and 0.2 m, or its length"),
    Factor("kerb_height", "m", 0.05, 0.12, 0.2, "of the kerb; 8 cm and more are detected"),
)
NEIGHBOURS = tuple(
    Factor(f"{name}_{which}", unit, low, nominal, high, text.format(which.upper()))
    for which in ("a", "b")
    for name, unit, low, nominal, high, text in (
        ("turn", "deg", -5.0, 0.0, 5.0, "neighbour {} is turned by this"),
        ("stagger", "m", -0.2, 0.0, 0.2, "the corner of neighbour {} at the slot stands out into the road by this"),
        ("length", "m", 3.6, 4.4, 5.0, "length of neighbour {}"),
        ("width", "m", 1.6, 1.8, 2.0, "width of neighbour {}"),
    )
)
SEARCH = (
    Factor("beside", "m", 0.5, 1.0, 1.5, "distance to the neighbours where the pass is nearest"),
    Factor("heading", "deg", -8.0, 0.0, 8.0, "of the pass against the road, positive away from the slot"),
    Factor("speed", "km/h", 3.6, 7.2, 25.0, "of the driver who searches"),
)
SENSORS = (
    Factor("noise", "m", 0.0, 0.0, 0.03, "standard deviation of a measurement"),
    Factor("dropout", "1", 0.0, 0.0, 0.05, "chance that a reading is lost"),
    Factor("resolution", "m", 0.005, 0.01, 0.03, "step of a reading"),
    Factor("cycle", "s", 0.04, 0.04, 0.08, "between readings; the controller has this value"),
    Factor("mount_place", "m", 0.0, 0.0, 0.015, "how far sensors sit off their places, each its own way"),
    Factor("mount_yaw", "deg", 0.0, 0.0, 2.0, "how far sensors look aside, each its own way"),
    Factor("cone", "deg", 26.0, 30.0, 34.0, "half opening of the cones; the controller believes 30"),
    Factor("radius_error", "1", -0.01, 0.0, 0.01, "of the wheels, as the odometry believes them"),
    Factor("steering_offset", "deg", -0.15, 0.0, 0.15, "of the front wheels, as measured: drift"),
    Factor("tick", "m", 0.0, 0.0, 0.04, "way rolled per wheel pulse"),
    Factor("steering_resolution", "deg", 0.0, 0.0, 0.1, "step of the front wheels' angle as measured"),
)
CAR = (
    Factor("body", "1", 0, 0, 1, "equations of motion", ("kinematic", "double_track")),
    Factor("steering_rate", "1", 0.8, 1.0, 1.2, "of the steering wheel, as a share of what the controller believes"),
    Factor("backlash", "deg", 0.0, 0.0, 5.0, "of the steering wheel"),
    Factor("dead_time", "s", 0.0, 0.0, 0.1, "of the steering"),
    Factor("lag", "s", 0.0, 0.0, 0.15, "of the steering"),
    Factor("grip", "1", 0.3, 1.0, 1.0, "of the road; double-track"),
    Factor("slope", "%", -5.0, 0.0, 5.0, "of the road, along it; double-track"),
    Factor("bank", "%", -5.0, 0.0, 5.0, "of the road, across it; double-track"),
    Factor("brake_lag", "s", 0.05, 0.05, 0.3, "of the brake; double-track"),
    Factor("drive_lag", "s", 0.1, 0.1, 0.3, "of the drive; double-track"),
    Factor("deceleration", "m/s2", 1.5, 3.0, 3.0, "the brake reaches"),
    Factor("exchange", "1", 0, 1, 2, "every so often", ("5 ms", "10 ms", "20 ms")),
)
EVENTS = (
    Factor(
        "person", "1", 0, 0, 5, "a pedestrian crosses the road", (*("nobody",) * 4, "into the slot", "out of the slot")
    ),
    Factor("person_at", "s", 5.0, 60.0, 60.0, "when"),
    Factor("person_speed", "m/s", 0.5, 0.5, 1.5, "how fast"),
    Factor("person_place", "1", -0.5, 1.5, 1.5, "where, as a share of the slot's length; outside it between cars"),
    Factor("mover", "1", 0, 0, 5, "a moving neighbour, along itself", (*("none",) * 4, "first", "second")),
    Factor("mover_at", "s", 5.0, 60.0, 60.0, "when"),
    Factor("mover_travel", "m", -1.0, 0.0, 1.0, "how far, positive into a parallel slot, out of a perpendicular row"),
    Factor("mover_speed", "m/s", 0.2, 0.2, 1.0, "how fast"),
    Factor("lost", "1", 0, 0, 9, "a sensor fails", (*("none",) * 8, "hears nothing", "says nothing")),
    Factor("lost_sensor", "1", 0, 0, 11, "which", tuple(map(str, range(1, 13)))),
    Factor("lost_at", "s", 2.0, 60.0, 60.0, "when"),
)
NOBODY, NO_SENSOR = 4, 8
"""Below these: nobody walks, no neighbour moves; no sensor fails."""
FACTORS = (*SLOT, *NEIGHBOURS, *SEARCH, *SENSORS, *CAR, *EVENTS)
STEPS = (0.005, 0.01, 0.02)
