"""What a run notes while it goes on, so that it can be continued later."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.integrate.events import EventMonitor
from vehicledyn.kernel.engine import March, Vector


@dataclass(frozen=True)
class Beginning:
    """Where a continued run begins: the time of a sample [s] that is not delivered again.

    ``history`` is what the method noted there; without it the method starts anew from the sample,
    and the motion agrees to the accuracy of the method. ``past`` gives times, states, unknowns and
    outputs of the samples up to there, block by block, if the same method with the same step made
    them. ``kept`` are the numbers that were kept up to then.
    """

    time: float
    history: Vector | None = None
    past: Callable[[], Iterable[tuple[Vector, ...]]] | None = None
    kept: Vector | None = None


@dataclass
class MethodState:
    """What a method knows where a piece of a run ends beyond the states; the next begins with it.

    ``numbers`` are the method's own, None at the start of a run and for methods of one step. Where
    steps keep the states on the constraints, ``holds_constraints`` says that these go on as they
    are.
    """

    numbers: Vector | None = None
    holds_constraints: bool = False


@dataclass(frozen=True)
class RunHistory:
    """Notes the history of a run; ``beginning`` is that of a continued one.

    ``note`` is given the time of the last sample delivered [s] and the numbers that the method
    needs to go on from where it is, which is that sample or less than one behind. ``keep`` is given
    numbers that all later notes build on.
    """

    note: Callable[[float, Vector], None]
    beginning: Beginning | None = None
    keep: Callable[[Vector], None] | None = None


def most_numbers(n_states: int, n_unknowns: int, n_events: int) -> int:
    """Return the largest length of a history; implicit steps carry three numbers a state more."""
    return 4 + 4 * n_states + 3 * n_unknowns + 1 + 3 * n_events


def history_of(march: March, watch: EventMonitor) -> Vector:
    """Return the numbers with which a run with fixed steps goes on."""
    parts = (march.state, march.unknowns, march.memory, march.sides, watch.memory)
    return np.concatenate([[march.step], *(np.asarray(part, dtype=float) for part in parts)])


@contextmanager
def reading_history() -> Iterator[None]:
    """Refuse numbers that are no history of this run, as a file that was changed may have them."""
    try:
        yield
    except (ValueError, IndexError, KeyError, OverflowError) as error:
        raise InputError(
            f"what the run has noted to go on from does not belong to it: run without "
            f"{argument('restart')}"
        ) from error


def go_on_from(history: Vector, march: March, watch: EventMonitor, first: int, last: int) -> None:
    """Set a run with fixed steps to where its history was noted, between steps first and last.

    Raises
    ------
    InputError
        If the history is not that of such a run.
    """
    with reading_history():
        step, place = int(history[0]), 1
        if not first <= step <= last:
            raise ValueError(f"step {step} is not between {first} and {last}")
        for part in (march.state, march.unknowns, march.memory, march.sides):
            part[:] = history[place : place + part.size]
            place += part.size
        watch.recall(history[place:])
    march.step = step
