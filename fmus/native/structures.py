"""C structures as ctypes has them, for the loops in C that follow tables."""

import ctypes
from typing import Any

Pointer, Long = ctypes.c_void_p, ctypes.c_int64


def structure(name: str, **fields: Any) -> Any:
    """Return the type of a C structure with these fields, in order."""
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})
