"""Policies: what acts on observations. A random one, and a learned one in an ONNX file."""

from pathlib import Path
from typing import Any, Protocol

import numpy as np

from apa_cosim.gym.spaces import Floats
from fmus.policy_fmu import FATAL_ONLY, BadPolicy, count_actions
from orchestrator.inputs.text.errors import BadInput


class Policy(Protocol):
    """Acts for many cars at once."""

    action_count: int
    """2: speed and steering wheel; 3: pedals and steering wheel."""

    def __call__(self, observations: Floats) -> Floats:
        """Return the actions (cars, 2 or 3) for observations (cars, 24)."""


class RandomPolicy:
    """Draws every action evenly from its range: the baseline that any policy must beat."""

    def __init__(self, seed: int = 0, action_count: int = 2) -> None:
        self._random, self.action_count = np.random.default_rng(seed), action_count

    def __call__(self, observations: Floats) -> Floats:
        """Return actions that do not depend on what is observed."""
        return self._random.uniform(-1.0, 1.0, (len(observations), self.action_count)).astype(np.float32)


class OnnxPolicy:
    """A network in an ONNX file: one input (cars, 24), one output (cars, 2 or 3) in float32, its mean action.

    One that was exported for one car acts for each in turn.

    Raises ``BadInput`` for a file that is none, and without onnxruntime (the extra ``onnx``).
    """

    def __init__(self, file: Path) -> None:
        if not file.is_file():
            raise BadInput("no such file", file=file)
        try:
            self.action_count = count_actions(file)
        except BadPolicy as error:
            raise BadInput(str(error), file=file) from error
        import onnxruntime

        settings = onnxruntime.SessionOptions()
        settings.intra_op_num_threads, settings.log_severity_level = 1, FATAL_ONLY
        self._session: Any = onnxruntime.InferenceSession(str(file), settings, providers=["CPUExecutionProvider"])
        (observations,) = self._session.get_inputs()
        self._input, self._one_by_one = observations.name, observations.shape[:1] == [1]

    def __call__(self, observations: Floats) -> Floats:
        """Return the network's actions, limited to their range."""
        parts = observations[:, None] if self._one_by_one else [observations]
        found = [self._session.run(None, {self._input: part})[0] for part in parts]
        return np.clip(np.concatenate(found).astype(np.float32).reshape(len(observations), -1), -1.0, 1.0)
