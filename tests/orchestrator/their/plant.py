"""Somebody's vehicle, made with PythonFMU: a kinematic car that counts its pose its own way."""

import math
from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Plant(Fmi2Slave):  # type: ignore[misc]
    """Position of the front axle [cm], x to the east and y to the south, heading clockwise from east [deg]."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.Steer, self.Demand, self.Travel = 0.0, 0.0, 0.0
        self.East, self.South, self.Course = 240.5, 0.0, 0.0
        self.RearX, self.RearY, self.Yaw, self.Speed = 0.0, 0.0, 0.0, 0.0
        for name in ("Steer", "Demand"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("East", "South", "Course", "Speed", "Travel"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.Wheelbase = 2.405
        self.register_variable(Real("Wheelbase", **fixed))

    def do_step(self, t: Any, dt: Any) -> Any:
        wheel = math.radians(self.Steer) / 19.0
        self.Speed = self.Demand
        self.Yaw += self.Speed * math.tan(wheel) / self.Wheelbase * dt
        self.RearX += self.Speed * math.cos(self.Yaw) * dt
        self.RearY += self.Speed * math.sin(self.Yaw) * dt
        self.East = 100.0 * (self.RearX + self.Wheelbase * math.cos(self.Yaw))
        self.South = -100.0 * (self.RearY + self.Wheelbase * math.sin(self.Yaw))
        self.Course = -math.degrees(self.Yaw)
        self.Travel += abs(self.Speed) * dt
        return True
