"""Who computes the blocks of a study: this process, or others that it hands them to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np

from vehicledyn.results.store.study_layout import StudyBlock
from vehicledyn.studies.block import Work, Worker

Span: TypeAlias = tuple[int, int]
Spans: TypeAlias = Iterator[Span]
Take: TypeAlias = Callable[[StudyBlock], None]

LIVES = 3
"""How many workers may die over a block before its cases are tried one by one."""


class Pool(Protocol):
    """Computes spans of cases and hands each block over as it comes."""

    @property
    def description(self) -> str:
        """Who computes, for people."""

    def workers(self) -> int:
        """Return the number of workers."""

    def compute(self, spans: Spans, take: Take) -> None:
        """Compute spans of cases in any order; ``take`` gets every block once."""

    def remarks(self) -> list[str]:
        """Return what the user should know of the computation."""


@dataclass(frozen=True)
class SingleProcess:
    """The process itself."""

    worker: Worker
    description: str = "one process"

    def workers(self) -> int:
        """Return the number of workers, one."""
        return 1

    def compute(self, spans: Spans, take: Take) -> None:
        """Compute one span after the other."""
        for first, stop in spans:
            take(self.worker.compute(first, stop))

    def remarks(self) -> list[str]:
        """Return nothing: there are no others that could fail."""
        return []


def divided(span: Span, work: Work, take: Take) -> list[Span]:
    """Return the cases of a block that killed its workers one by one; fail a single one."""
    first, stop = span
    if stop - first > 1:
        return [(number, number + 1) for number in range(first, stop)]
    block = StudyBlock(first, work.design.cases(first, stop))
    block.fail(0, float(np.nan), f"the worker process died {LIVES} times computing this case")
    take(block)
    return []
