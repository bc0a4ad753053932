"""The slave inside a PythonFMU that carries out a learned policy: it asks the network for an action each period.

The network is ``resources/policy.onnx``; it is run by onnxruntime, in one thread, in the Python of the host.
"""

import os
from collections.abc import Callable
from importlib import import_module
from typing import Any, ClassVar

from fmus.python.layout import POLICY_FILE
from fmus.python.slave import ModelSlave


class PolicySlave(ModelSlave):
    """Base of the slave classes: a subclass names its ``model``, its ``build`` and its ``period_ns``."""

    period_ns: ClassVar[int]
    """Between two actions; the first one comes after the first step."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._policy: Callable[[tuple[float, ...]], tuple[float, ...]] | None = None

    def _use(self, store: Any) -> None:
        """Step with these work arrays from now on, with the actions of the policy."""
        super()._use(store)
        if self._policy is None:
            self._policy = load_policy(os.path.join(self.resources, POLICY_FILE))
        policy, step, period_ns = self._policy, self._step, self.period_ns

        def step_with_policy(state: Any, inputs: Any, params: Any, dt_ns: int) -> Any:
            action = state.action
            time_ns = state.clock.time_ns
            if time_ns >= dt_ns and (time_ns - dt_ns) % period_ns == 0:
                action = policy(state.outputs.observation)
            return step(state, inputs._replace(action=action), params, dt_ns)

        self._step = step_with_policy


def load_policy(path: str) -> Callable[[tuple[float, ...]], tuple[float, ...]]:
    """Return the action, three numbers from -1 to 1, for an observation. Raises ``ImportError`` without onnxruntime."""
    try:
        numpy, runtime = import_module("numpy"), import_module("onnxruntime")
    except ImportError as error:
        raise ImportError("this FMU runs an ONNX policy: install onnxruntime in the Python of the host") from error
    settings = runtime.SessionOptions()
    settings.intra_op_num_threads = settings.inter_op_num_threads = 1
    settings.log_severity_level = 4  # its warnings have names of the file, with whatever control characters
    session = runtime.InferenceSession(path, settings, providers=["CPUExecutionProvider"])
    name = session.get_inputs()[0].name

    def policy(observation: tuple[float, ...]) -> tuple[float, ...]:
        found = session.run(None, {name: numpy.array([observation], dtype=numpy.float32)})[0]
        action = [float(value) for value in numpy.clip(found.reshape(-1).astype(numpy.float32), -1.0, 1.0)]
        return (*action, *(0.0,) * (3 - len(action)))

    return policy
