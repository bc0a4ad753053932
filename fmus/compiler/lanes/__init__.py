"""Lanes of runs: C that advances several instances of a model at once, one in each element of a vector.

It is made of the C that the translator writes. That is a small language: numbers, structs, arrays of fixed length,
pointers that every instance shares, calls, branches and loops. Each number becomes a vector of ``LANES`` elements. A
branch becomes a mask of the instances that take it, and is skipped where none does.
"""

from fmus.compiler.lanes.kinds import NoLanesError
from fmus.compiler.lanes.translation import lanes_of

__all__ = ["NoLanesError", "lanes_of"]
