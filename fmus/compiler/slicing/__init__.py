"""Program slicing: the part of a model's code on which its live outputs depend.

A backward slice (Weiser 1984) over all functions of a model at once. It is flow-insensitive within a function and
keeps one set of live fields for each NamedTuple class: a statement is live if it binds a live variable, returns,
leaves a live loop or writes to a store; a constructor's argument is live if its field is read in live code, or is a
live output. State that only dead outputs read is dead with all that computes it. Dead arguments and fields become
zeros, so that types and the layout of the state stay as they are.
"""

from fmus.compiler.slicing.code_kinds import fields_along
from fmus.compiler.slicing.slices import DeadValue, Slice, SlicedLibrary, slice_program, solve_liveness

__all__ = ["DeadValue", "Slice", "SlicedLibrary", "fields_along", "slice_program", "solve_liveness"]
