"""What cannot be proved equal in C is refused: all of it at once, each with its line and what to write instead."""

import itertools
from pathlib import Path
from typing import Any

import pytest

from fmus.compiler import UnsupportedError, translate
from tests.compiler.bad_programs import BODIES, FRAME, HEAD, MODULES, WHOLE
from tests.compiler.language import load, model_of

numbers = itertools.count()


def refusals_of(text: Any, folder: Any) -> Any:
    """Return what is said of a module, and the lines marked in it."""
    module = load(text, folder, f"bad_{next(numbers)}")
    marked = [number for number, line in enumerate(text.splitlines(), start=1) if "# !" in line]
    with pytest.raises(UnsupportedError) as refused:
        translate(model_of(module))
    for item in refused.value.refusals:
        assert item.file == f"{module.__name__}.py"
        assert str(item) in str(refused.value)
    return refused.value.refusals, marked


def function(body: Any) -> Any:
    return WHOLE + "\n".join(f"    {line}" for line in body.splitlines()) + "\n"


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_bad_body_is_refused(name: Any, tmp_path: Path) -> None:
    body, what, advice = BODIES[name]
    found, marked = refusals_of(HEAD + function(body) + FRAME, tmp_path)
    assert [item.line for item in found] == marked
    assert what in found[0].what
    assert advice in found[0].advice


@pytest.mark.parametrize("name", MODULES)
def test_bad_definition_is_refused(name: Any, tmp_path: Path) -> None:
    definition, call, what, advice = MODULES[name]
    call, _, mark = call.partition("  ")
    body = f"return {call}  {mark}"
    found, marked = refusals_of(HEAD + definition + "\n\n" + function(body) + FRAME, tmp_path)
    assert [item.line for item in found] == marked
    assert what in found[0].what
    assert advice in found[0].advice


def test_decorated_function_is_refused(tmp_path: Path) -> None:
    text = HEAD.replace("def half", "def same(g):\n    return g\n\n\n@same  # !\ndef half")
    found, marked = refusals_of(text + function("return half(x)") + FRAME, tmp_path)
    assert [item.line for item in found] == marked
    assert "decorator" in found[0].what


def test_all_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    body = "y = [x]  # !\nz = y[0]\nfor k in n:  # !\n    x += 1\nx = x ** 2  # !\nif x:\n    return 1  # !\n"
    body += "return half(2)  # !"
    found, marked = refusals_of(HEAD + function(body) + FRAME, tmp_path)
    assert [item.line for item in found] == marked


def test_there_are_many_of_them() -> None:
    assert len(BODIES) + len(MODULES) > 120
