"""Ctrl-C at moments when it would do harm or be lost."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator


class Interrupts:
    """Ctrl-C while it is put off; ``is_pressed`` says whether it waits."""

    def __init__(self) -> None:
        self.is_pressed = self.is_let_through = False

    @contextlib.contextmanager
    def let_through(self) -> Iterator[None]:
        """Let Ctrl-C interrupt what is done meanwhile."""
        self.is_let_through = True
        try:
            yield
        finally:
            self.is_let_through = False


@contextlib.contextmanager
def undisturbed() -> Iterator[Interrupts]:
    """Put Ctrl-C off until the block is done.

    For what it would break half way, such as HDF5's writing, and for work on CasADi's scalars:
    CasADi swallows most interrupts that arrive inside its operators.
    """
    before, interrupts = signal.getsignal(signal.SIGINT), Interrupts()
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield interrupts
        return

    def note(number: int, frame: object) -> None:
        if interrupts.is_let_through:
            before(number, frame)  # type: ignore[arg-type]
        else:
            interrupts.is_pressed = True

    signal.signal(signal.SIGINT, note)
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, before)
        if interrupts.is_pressed:
            signal.raise_signal(signal.SIGINT)


@contextlib.contextmanager
def heeded() -> Iterator[None]:
    """Let Ctrl-C end the block, also where what it calls takes it for a failure of its own."""
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    is_pressed = False

    def note(number: int, frame: object) -> None:
        nonlocal is_pressed
        is_pressed = True
        before(number, frame)  # type: ignore[arg-type]

    signal.signal(signal.SIGINT, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if is_pressed:
            raise KeyboardInterrupt
