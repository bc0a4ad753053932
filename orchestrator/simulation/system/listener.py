"""An instance that only listens: signals are seen under its name, nothing is computed."""

from orchestrator.simulation.cosim.fmu_instance import Ports


class Listener:
    """Gives roles a name to be seen under, where no instance is called that."""

    identity = ""
    has_variable_step = True

    def __init__(self, name: str) -> None:
        self.name = name
        self.inputs, self.outputs, self.parameters = Ports([]), Ports([]), Ports([])

    def initialize(self, stop_ns: int) -> None:
        """Nothing to initialize."""

    def start(self) -> None:
        """Nothing to start."""

    def fetch_outputs(self) -> None:
        """It has none."""

    def send_inputs(self) -> None:
        """Nobody to send them to."""

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Time passes."""

    def close(self) -> None:
        """Nothing to free."""
