"""The door to result files: write one, check where it may go, open one."""

from __future__ import annotations

from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.layout import EventRecord, ResultHeader, SceneItem, SummaryEntry
from vehicledyn.results.store.reader import Result, open_result
from vehicledyn.results.store.values import Series, StateTable
from vehicledyn.results.store.writer import ResultWriter

__all__ = [
    "EventRecord",
    "Result",
    "ResultHeader",
    "ResultWriter",
    "SceneItem",
    "Series",
    "StateTable",
    "SummaryEntry",
    "check_output",
    "open_result",
]
