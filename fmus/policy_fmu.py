"""From an ONNX policy to a controller FMU: the policy's controller as a PythonFMU with the network inside."""

from importlib import import_module
from pathlib import Path

from controller_fmu import POLICY
from fmus.native.libraries import python_front
from fmus.python.fmu import PolicyFile, build
from modelkit.model import Model
from modelkit.variables import variables

ACTION = "action["
OBSERVATION = "observation["
PEDALS = {2: False, 3: True}
"""Number of actions -> whether they are those of pedals."""
FLOAT32 = "tensor(float)"
"""Name of onnxruntime."""
FATAL_ONLY = 4
"""Severity of onnxruntime's messages: its warnings bring names of the file to the terminal, with control characters."""
ACTION_PERIOD = 0.2
"""Between two actions [s], where nothing else is given."""
MAX_ACTION_PERIOD = 10.0
"""[s]"""


class BadPolicy(ValueError):  # noqa: N818 - said as it is
    """Why a file cannot be the policy of a controller."""


def policy_model(name: str, pedals: bool) -> Model:
    """Return the policy's controller as the FMU called ``name`` has it: the actions are its own."""
    inputs = [item.name for item in variables(POLICY.inputs)]
    hidden = POLICY.view.hidden | {item for item in inputs if item.startswith(ACTION)}
    model = POLICY._replace(name=name, view=POLICY.view._replace(hidden=hidden))
    return model.with_start_values({"action.pedals": pedals})


def build_policy_fmu(name: str, network: Path, period: float, out: Path) -> Path:
    """Return the path of ``out/<name>.fmu``, a controller that acts every ``period`` [s] as ``network`` says.

    Raises ``BadPolicy`` for a file that is no policy, and without onnxruntime.
    """
    if not 0.0 < period <= MAX_ACTION_PERIOD:
        raise BadPolicy(f"a period of {period:g} s: expected more than 0 and at most {MAX_ACTION_PERIOD:g} s")
    actions = count_actions(network)
    policy = PolicyFile(network.read_bytes(), round(period * 1e9))
    return build(policy_model(name, PEDALS[actions]), out, python_front(), policy)


def count_actions(network: Path) -> int:
    """Return how many actions a policy has, 2 or 3, tried with an observation of zeros. Raises ``BadPolicy``."""
    try:
        numpy, runtime = import_module("numpy"), import_module("onnxruntime")
    except ImportError as error:
        raise BadPolicy("needs onnxruntime: install apa-cosim[onnx]") from error
    count = sum(item.name.startswith(OBSERVATION) for item in variables(POLICY.outputs))
    expected = f"expected one input (cars, {count}) and one output (cars, 2 or 3) in float32"
    try:
        settings = runtime.SessionOptions()
        settings.log_severity_level = FATAL_ONLY
        session = runtime.InferenceSession(str(network), settings, providers=["CPUExecutionProvider"])
        inputs, outputs = session.get_inputs(), session.get_outputs()
        widths = [item.shape[-1] if item.shape else count for item in inputs]
        known = [width for width in widths if isinstance(width, int)]
        if len(inputs) != 1 or len(outputs) != 1 or inputs[0].type != FLOAT32 or known not in ([], [count]):
            ports = ", ".join(f"{item.name} {item.shape} {item.type}" for item in (*inputs, *outputs))
            raise BadPolicy(f"has {ports}: {expected}")
        found = session.run(None, {inputs[0].name: numpy.zeros((1, count), dtype=numpy.float32)})[0]
    except BadPolicy:
        raise
    except Exception as error:  # onnxruntime has an exception of its own for each mistake
        raise BadPolicy(f"is no policy of {count} observations: {str(error).splitlines()[0]}") from error
    if found.shape not in ((1, 2), (1, 3)):
        raise BadPolicy(f"gives {found.shape}: {expected}")
    return int(found.shape[1])
