"""Names, types and rules of the result file's layout, shared by writer and reader.

The file is NetCDF-4 compatible HDF5::

    /                    attributes: format, format_version, title, status, status_message,
                         created, vehicledyn_version, model, model_hash, channels
    /time                dimension scale (n_times,) [s]
    /wheel_fl/tyre/...   channel ``wheel_fl.tyre...``, shape (n_times,)
    /states/value        (n_times, n_states), with /states/name and /states/units
    /events/at, name     instants [s] and names of events
    /summary/...         scalars or texts with units and long_name
    /scenario/text, configuration, sources, parameters (JSON), notes (texts)
    /solver, /versions   attributes
    /plots/descriptions  JSON
    /scene/...           static data such as cones
    /animation/...       shapes and poses of bodies, see
    :mod:`vehicledyn.results.store.animation_section`
    /restart/...         what a continued run needs, see :mod:`vehicledyn.results.store.history`
    /checksums/row, crc  checksums of the samples, see :mod:`vehicledyn.results.store.row_checksums`
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from vehicledyn.base.errors import InputError

FORMAT = "vehicledyn-result"
FORMAT_VERSION = 1
ENDED = ("ok", "derailed", "lifted", "overturned", "sunk", "driver_lost")
"""Statuses of runs that ended by themselves: as planned, or where their model no longer holds."""

STATUSES = ("running", *ENDED, "failed", "interrupted")
CHECKSUMS = "checksums"
RESTART = "restart"
RESERVED = (
    "time",
    "states",
    "events",
    "summary",
    "scenario",
    "solver",
    "versions",
    "plots",
    "scene",
    "animation",
    CHECKSUMS,
    RESTART,
)


class Described(Protocol):
    """Anything with a dotted name, a unit and a meaning, such as a state."""

    @property
    def name(self) -> str:
        """Dotted name from whole to part."""

    @property
    def unit(self) -> str:
        """SI unit of the values."""

    @property
    def description(self) -> str:
        """Meaning, one phrase."""


class Framed(Described, Protocol):
    """A described quantity that also states the frame it is expressed in: a channel."""

    @property
    def frame(self) -> str:
        """Frame the values are expressed in, empty for quantities without one."""


@dataclass(frozen=True)
class SceneItem:
    """Static data a plot may show, such as the cones of a course.

    ``values`` may have any shape; ``attributes`` are numbers or texts, such as ``radius``.
    """

    values: ArrayLike
    unit: str
    description: str
    attributes: Mapping[str, float | str] = field(default_factory=dict)


@dataclass(frozen=True)
class SummaryEntry:
    """One line of the run's summary: a number, truth value or text."""

    name: str
    value: float | int | bool | str
    unit: str
    description: str


@dataclass(frozen=True)
class EventRecord:
    """An event that happened at a time [s]."""

    time: float
    name: str


@dataclass(frozen=True)
class SampleAxis:
    """What the samples are counted along: the time, if not said otherwise."""

    unit: str = "s"
    description: str = "Time"
    name: str = "time"


@dataclass(frozen=True)
class ResultHeader:
    """What is known of a run before it starts.

    ``configuration`` is the resolved scenario and ``plots`` the plot descriptions, both
    plain data that JSON can hold; ``sources`` say of each part used its "part", what it "does"
    and its "source"; ``versions`` adds to the packages' own versions. ``axis``
    describes the dataset "time" where the samples are not taken in time. ``model_hash`` changes
    with the equations and the parameters, ``equations_hash`` with the equations alone, and
    ``parameters`` are value in SI and unit by name.
    """

    title: str
    model: str
    model_hash: str = ""
    scenario_text: str = ""
    configuration: Mapping[str, Any] = field(default_factory=dict)
    plots: Sequence[Mapping[str, Any]] = ()
    scene: Mapping[str, SceneItem] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    sources: Sequence[Mapping[str, str]] = ()
    axis: SampleAxis = field(default_factory=SampleAxis)
    equations_hash: str = ""
    parameters: Mapping[str, tuple[float, str]] = field(default_factory=dict)


def dataset_path(name: str) -> str:
    """Return where a dotted name lies in the file.

    >>> dataset_path("wheel_fl.tyre.normal_force")
    '/wheel_fl/tyre/normal_force'
    """
    return "/" + name.replace(".", "/")


def check_names(names: Iterable[str]) -> None:
    """Refuse channel names that cannot lie together in one file.

    Raises
    ------
    InputError
        If a name is empty, reserved, given twice, or a channel and a group at once.
    """
    seen: set[str] = set()
    for name in names:
        parts = name.split(".")
        if not all(parts) or "/" in name or "\0" in name:
            raise InputError(f"channel '{name}': a name is made of words joined by dots")
        if parts[0] in RESERVED:
            raise InputError(f"channel '{name}': '{parts[0]}' is reserved; rename the part")
        if name in seen:
            raise InputError(f"channel '{name}' is defined twice; rename one of them")
        seen.add(name)
    groups = {
        name.rsplit(".", count)[0] for name in seen for count in range(1, name.count(".") + 1)
    }
    for name in sorted(groups & seen):
        raise InputError(f"channel '{name}' is also the name of a part with channels; rename one")


def clean_text(text: str) -> str:
    """Return a text that HDF5 can hold: no NUL and no lone surrogates."""
    return text.replace("\0", "\\0").encode("utf-8", "backslashreplace").decode("utf-8")


def attribute(value: Any) -> Any:
    """Return a value as HDF5 holds it in an attribute; structures become JSON."""
    if isinstance(value, str):
        return clean_text(value)
    if isinstance(value, bool | np.bool_):
        return np.int8(value)
    if isinstance(value, int | float | np.integer | np.floating):
        return value
    return clean_text(json.dumps(value, default=str))
