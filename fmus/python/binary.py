"""What the FMI binary of PythonFMU 0.7 gets wrong about threads, references and the path, repaired from inside.

At every instantiation it drops one reference to the namespace of the slave's script too many, and leaves the FMU's
folder in ``sys.path``. When an exception comes out of a method (a KeyboardInterrupt can strike before the first line
of one) it gives up its references to slave, class and log, but keeps the pointers and gives them up again later. In a
thread that Python did not start, every call makes and destroys a thread state. At the end of a Python program it looks
once more at what it has freed, which may end in an abort after all is done.

``threading`` is not imported: in a host that is no Python program it would take the importing thread for Python's main
thread, and wait for it for ever when the process ends.
"""

import atexit
import ctypes
import os
import sys
from _thread import _local, allocate_lock
from typing import Any

PINNED = _local()
LOCK = allocate_lock()
KEPT: list[Any] = []
"""Slaves with a spare reference each, and one to their log."""
LIBRARIES: set[str] = set()
"""Paths of PythonFMU's libraries of the instances so far."""
FREED_AFTER_EXCEPTION = 2
"""``sys.getrefcount`` of a slave that only ``KEPT`` and the call itself know: its spare reference is used up."""
FREED_WITH_REFERENCE = FREED_AFTER_EXCEPTION + 1
"""The same with the spare reference left."""


def pin_thread() -> None:
    """Keep this thread's Python state alive until the thread ends."""
    if not hasattr(PINNED, "done"):
        ctypes.pythonapi.PyGILState_Ensure()
        PINNED.done = True


def keep(slave: Any) -> None:
    """Give ``slave``, its log, its class and its script a spare reference; take those of freed slaves back."""
    cls = type(slave)
    spare = [slave, slave.log_queue, cls]
    if cls.__module__ in sys.modules:
        spare.append(vars(sys.modules[cls.__module__]))
    for item in spare:
        _add_reference(item, 1)
    with LOCK:
        _take_back()
        KEPT.append(slave)


def _take_back() -> None:
    for place in reversed(range(len(KEPT))):
        count = sys.getrefcount(KEPT[place])
        if count <= FREED_WITH_REFERENCE:
            freed = KEPT.pop(place)
            if count == FREED_WITH_REFERENCE:
                _add_reference(freed.log_queue, -1)
                _add_reference(freed, -1)


def tidy_path(resources: str | None) -> None:
    """Take the FMU's folder out of ``sys.path``: all of its modules are imported by now."""
    while resources in sys.path:
        sys.path.remove(resources)


def end_once(resources: str) -> None:
    """Have PythonFMU's library of these ``resources`` give up its interpreter before a Python program ends.

    Nothing is left then that it could look at after freeing it. In another host the interpreter is its own, and it
    ends it: such an interpreter has no command line.
    """
    if sys.platform != "linux" or not sys.orig_argv:
        return
    if not LIBRARIES:
        atexit.register(_finalize)
    folder = os.path.join(os.path.dirname(resources.rstrip("/")), "binaries", "linux64")
    if os.path.isdir(folder):
        LIBRARIES.update(os.path.join(folder, name) for name in os.listdir(folder))


def _finalize() -> None:
    for path in LIBRARIES:
        try:  # of those loaded: most are unloaded by now, and their files are gone
            ctypes.CDLL(path, mode=os.RTLD_NOW | os.RTLD_NOLOAD).finalizePythonInterpreter()
        except (OSError, AttributeError):
            continue


def _add_reference(item: Any, change: int) -> None:
    call = ctypes.pythonapi.Py_IncRef if change > 0 else ctypes.pythonapi.Py_DecRef
    call(ctypes.py_object(item))
