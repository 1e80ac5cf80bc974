"""Names, types and rules of the file of a study, shared by writer and reader.

The file is HDF5; only what its status calls done counts::

    /                    attributes: format, format_version, title, created, vehicledyn_version,
                         cases, digests, configuration
    /state               status (running, ok, interrupted, failed) and message, as texts
    /time                (n_samples,) [s]
    /channels/name, units, long_name
    /samples             (n_cases, n_samples, n_channels), chunks of whole cases
    /axes/name, units, choices
    /cases/values        (n_cases, n_axes) in SI; the number of a choice
    /cases/status        (n_cases,), see STATUS_NAMES
    /cases/end_time      (n_cases,) [s]
    /cases/reason        (n_cases,) why a case failed or is inaccurate, which event ended it
    /figures/name, units, long_name, value (n_cases, n_figures), text (n_cases, n_figures)
    /study/text, /scenario/text
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FORMAT = "vehicledyn-study"
FORMAT_VERSION = 1

PENDING, DONE, FAILED, ENDED, LOST = 0, 1, 2, 3, 4
STATUS_NAMES = ("pending", "done", "failed", "ended by an event", "driver_lost")
RUNNING, OK, INTERRUPTED, STOPPED = "running", "ok", "interrupted", "failed"

ACCURACY = "accuracy"
"""Name of the figure, a text, that says how accurate a case with a fixed step is."""

BEND = "largest_bend."
"""Begins the figures that say how far the end of a beam of assumed modes moved aside."""

REASON_BYTES = 240
TEXT_BYTES = 40
NAME_BYTES = 96
MESSAGE_BYTES = 400

Floats = NDArray[np.float64]


class StudyFigure(NamedTuple):
    """A key figure of one case."""

    name: str
    value: float | int | bool | str
    unit: str
    description: str


class StudyChannel(NamedTuple):
    """Name, unit and meaning of a channel."""

    name: str
    unit: str
    description: str


class StudyAxis(NamedTuple):
    """Name and unit of what varies; of a choice its texts instead of a unit."""

    name: str
    unit: str
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class StudyHeader:
    """What is known of a study before its first case.

    ``digests`` decide whether work may go on in a file: by name, such as "scenario".
    ``chunk`` is the number of cases that are written together.
    """

    title: str
    n_cases: int
    times: Floats
    channels: Sequence[StudyChannel]
    axes: Sequence[StudyAxis]
    chunk: int
    single: bool
    study_text: str
    scenario_text: str
    digests: Mapping[str, str]
    configuration: Mapping[str, Any] = field(default_factory=dict)

    @property
    def case_bytes(self) -> int:
        """Bytes of the samples of one case."""
        return len(self.times) * len(self.channels) * (4 if self.single else 8)

    @property
    def total_bytes(self) -> float:
        """Bytes that the whole file takes, about."""
        return float(self.n_cases) * (self.case_bytes + 8 * len(self.axes) + 9 + 8 * 16)


@dataclass
class StudyBlock:
    """Cases that were computed: ``first`` is the number of the first one.

    ``values`` (n, n_axes); ``samples`` (n, n_samples, n_channels) or None if none has any;
    samples that a case did not reach are not a number.
    """

    first: int
    values: Floats
    status: NDArray[np.int8] = field(init=False)
    end_time: Floats = field(init=False)
    reasons: dict[int, str] = field(default_factory=dict)
    figures: dict[int, list[StudyFigure]] = field(default_factory=dict)
    samples: NDArray[Any] | None = None

    def __post_init__(self) -> None:
        """Begin with nothing done."""
        self.status = np.zeros(len(self.values), dtype=np.int8)
        self.end_time = np.zeros(len(self.values))

    def __len__(self) -> int:
        """Return the number of cases."""
        return len(self.values)

    def fail(self, number: int, time: float, reason: str) -> None:
        """Note that a case of this block failed at a time [s]."""
        self.status[number], self.end_time[number] = FAILED, time
        self.reasons[number] = " ".join(reason.split())

    def room(self, n_samples: int, n_channels: int, *, single: bool) -> NDArray[Any]:
        """Return the samples, made when first asked for."""
        if self.samples is None:
            kind = np.float32 if single else np.float64
            self.samples = np.full((len(self), n_samples, n_channels), np.nan, dtype=kind)
        return self.samples


def fitted(text: str, size: int) -> bytes:
    """Return a text as UTF-8 of at most some bytes, no letter cut apart."""
    raw = text.replace("\0", "").encode("utf-8", "backslashreplace")
    if len(raw) <= size:
        return raw
    return raw[: size - 3].decode("utf-8", "ignore").encode() + b"..."
