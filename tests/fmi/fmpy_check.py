"""FMPy's check of an FMU; its parser takes a millisecond a name, and most names are in many FMUs of the tests."""

from functools import cache
from pathlib import Path
from typing import Any

import lark
import pytest
from fmpy.validation import validate_fmu

LARK = lark.Lark


class OnceParser:
    """Parses each name once a process; those that it refuses raise again."""

    def __init__(self, grammar: str, start: str) -> None:
        self.parse = parsing(grammar, start)


@cache
def parsing(grammar: str, start: str) -> Any:
    return cache(LARK(grammar, start=start).parse)


def problems_of(fmu: Path | str) -> list[str]:
    """Return what FMPy finds wrong with an FMU."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lark.Lark", OnceParser)
        return list(validate_fmu(str(fmu)))
