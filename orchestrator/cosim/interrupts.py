"""Ctrl-C and SIGTERM end a run after the exchange in hand; a second one ends the program at once."""

from contextlib import AbstractContextManager

from orchestrator.cosim.algorithm import Interrupt
from orchestrator.text.ends import stop_on_signal


def on_interrupt(interrupt: Interrupt) -> AbstractContextManager[None]:
    """Set ``interrupt.requested`` on the first signal."""

    def request() -> None:
        interrupt.requested = True

    return stop_on_signal(request)
