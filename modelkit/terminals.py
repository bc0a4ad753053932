"""The plugs between vehicle and controller: each signal that one hands to the other is in one of them."""

from modelkit.model import Terminal

TERMINALS = (
    Terminal(
        "odometry",
        "where the car is, as it measures itself",
        ("odometry", "measured_speed", "steering_wheel_angle", "gear", "vehicle_fault"),
    ),
    Terminal("ultrasonic", "distances the sensors tell", ("ultrasonic",)),
    Terminal(
        "driver",
        "prompts to the driver, and the driver's actions",
        ("prompt", "advised_speed", "brake_pedal", "driver_takeover", "apa_switch", "driver_confirm"),
    ),
    Terminal(
        "actuators",
        "what the controller asks of steering, drive and brake",
        (
            "steering_active",
            "steering_wheel_request",
            "speed_control_active",
            "speed_request",
            "force_control_active",
            "force_request",
            "brake_request",
        ),
    ),
)
