"""Types that a model is made of, as variables; what a type checker takes for them where none is said is in the stub."""

from typing import TypeVar

State = TypeVar("State")
Params = TypeVar("Params")
Input = TypeVar("Input")
Output = TypeVar("Output")
Own = TypeVar("Own")
Clock = TypeVar("Clock")
