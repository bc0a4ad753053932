"""What the translator refuses, each with its place and what to write instead."""

import ast
from typing import NamedTuple


class Diagnostic(NamedTuple):
    """One construct that the translator cannot prove equal in C."""

    file: str
    line: int
    what: str
    advice: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.what}: {self.advice}"


class UnsupportedError(TypeError):
    """A model that cannot be translated, with every reason."""

    def __init__(self, refusals: list[Diagnostic]) -> None:
        self.refusals = sorted(set(refusals))
        super().__init__("\n".join(str(item) for item in self.refusals))


class CannotError(Exception):
    """Raised inside the translator at the construct that is refused."""

    def __init__(self, node: ast.AST | None, what: str, advice: str) -> None:
        super().__init__(what)
        self.node = node
        self.what = what
        self.advice = advice


class AlreadySaidError(Exception):
    """Raised where a value is needed whose making was refused before: it need not be said twice."""
