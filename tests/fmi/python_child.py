"""A host of a PythonFMU by ctypes, in a process of its own: python_child.py '{"folder": ..., "uri": ...}'.

Prints as JSON what the logger heard and what came of each call; a crash shows in the exit code alone.
"""

import ctypes
import json
import sys
from ctypes import byref, c_double, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

from tests.fmi.raw import LOGGER, Callbacks

TOLD = json.loads(sys.argv[1])
FOLDER = Path(TOLD["folder"])
DLL = ctypes.CDLL(str(FOLDER / "binaries/linux64/Toy.so"))
DLL.fmi2Instantiate.restype = c_void_p
HEARD: list[tuple[int, str]] = []
NOTHING: Any = None


def call(function: Any, *arguments: Any) -> Any:
    return getattr(DLL, f"fmi2{function}")(*arguments)


def asked_for_nothing(component: Any) -> Any:
    """Return the statuses of calls with no references, and no memory for them."""
    kinds = ("GetReal", "GetInteger", "GetBoolean", "GetString", "SetReal", "SetInteger", "SetBoolean", "SetString")
    return [call(kind, component, None, c_size_t(0), None) for kind in kinds]


def main() -> None:
    heard = LOGGER(lambda _, name, status, category, text: HEARD.append((status, text.decode())))
    logger: Any = heard if TOLD.get("logger", True) else ctypes.cast(NOTHING, LOGGER)
    callbacks = Callbacks(logger, None, None, None, None)
    guid = TOLD.get("guid", (FOLDER / "resources/guid.txt").read_text())
    functions = byref(callbacks) if TOLD.get("functions", True) else None
    name, uri = TOLD.get("name", "toy"), TOLD.get("uri")
    strings = [text and text.encode() for text in (name, guid, uri)]
    found: dict[str, Any] = {"heard": HEARD}
    component = c_void_p(call("Instantiate", strings[0], 1, strings[1], strings[2], functions, 0, 1))
    found["made"] = bool(component)
    if component:
        found["nothing"] = asked_for_nothing(component)
        found["null"] = call("GetReal", component, None, c_size_t(1), None)
        call("SetupExperiment", component, 0, c_double(0.0), c_double(0.0), 0, c_double(0.0))
        call("EnterInitializationMode", component)
        call("ExitInitializationMode", component)
        found["before"] = asked_for_nothing(component)
        found["steps"] = [call("DoStep", component, c_double(k * 0.01), c_double(0.01), 1) for k in range(5)]
        value, reference = c_double(), c_uint(TOLD["reference"])
        found["get"] = call("GetReal", component, byref(reference), c_size_t(1), byref(value))
        found["value"] = value.value
        if not TOLD.get("leave"):
            call("FreeInstance", component)
    found["without"] = [call("DoStep", None, c_double(0.0), c_double(0.01), 1), call("FreeInstance", None) and 0]
    print(json.dumps(found))


main()
