"""Derivatives of cams: lift, pressure angle, curvature, forces by measures of cam and follower."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.cams.view import cam_columns
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.analyses.sensitivity.names import matching
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import ParameterSet, field_unit
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.cams.cam_file import CamFile, read_cam
from vehicledyn.cams.outlines.arcs import Arcs
from vehicledyn.cams.outlines.points import MeasuredPoints
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_FORM = "cam(COLUMN, 30 deg) or cam(max(COLUMN))"
_EXTREME = re.compile(r"(max|min|peak)\((\w+)\)")
_WORDS = {"max": "Maximum", "min": "Minimum", "peak": "Largest size"}
_FEWEST = 3600
"""Angles of a turn, at least, among which an extreme is sought."""

_STEP, _BESIDE = 1e-40, 1e-9
_CORNER, _NEGLIGIBLE = 1e-6, 1e-12
"""Part of a derivative by which those at both sides of an angle may differ, without a corner, and
part of a column's largest size by which its measures move it at least for that."""


@dataclass(frozen=True)
class _Measure:
    """A number of a cam: where it stands, and how far each place moves with it."""

    quantity: Quantity
    value: float
    places: tuple[tuple[tuple[str | int, ...], float], ...]


def find_cam_sensitivity(
    file: str, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of columns of a cam by measures of cam, follower, motion and load.

    Parameters
    ----------
    file
        File of a cam with a motion.
    of
        Names such as ``cam(profile_radius, 30 deg:60 deg:3)`` and ``cam(peak(pressure_angle))``.
    to
        Patterns of measures, such as ``follower.*`` and ``motion.1.lift``.
    progress
        Called with what is going on.
    memory
        Not used: it takes no time.

    Raises
    ------
    InputError
        If the cam cannot be used, or a name means nothing.
    """
    asked = [_parsed(name) for name in of]
    cam = read_cam(Path(file))
    progress("differentiating the cam", None)
    measures = list(_measures(cam))
    chosen = [measures[k] for k in matching([m.quantity.name for m in measures], to, cam.title)]
    lowest_at = None if cam.outline is None else cam.lowest()[1]
    moved = [_moved(cam, measure, lowest_at) for measure in chosen]
    scales = np.array([abs(m.value) or 1.0 for m in chosen])
    known = cam_columns(cam, cam.samples(max(cam.steps, _FEWEST))[:-1])
    sizes = {name: _largest(np.asarray(item.values)) for name, item in known.items()}
    figures, values, slopes, notes = [], [], [], []
    for name, (kind, column, angles) in zip(of, asked, strict=True):
        if column not in known:
            raise InputError(f"'{name}': {unknown_name('column', column, known)}")
        for theta in [_extreme(cam, kind, column)] if kind else angles:
            unit, words = known[column].unit, known[column].description
            title = f"{kind}({column})" if kind else f"{column} at {shown(theta, 'rad')}"
            if kind:
                words = f"{_WORDS[kind]} of {words[0].lower()}{words[1:]}"
            quantity = Quantity(title, unit, words)
            sized = column, sizes[column]
            value, slope, has_corner = _found(cam, sized, theta, moved, scales)
            sign = np.sign(value) if kind == "peak" else 1.0
            figures.append(quantity)
            values.append(sign * value)
            slopes.append(sign * slope)
            if has_corner:
                at = shown(theta, "rad")
                notes.append(f"warning: '{title}' has a corner at {at}, where no derivative exists")
    return SensitivityTable(
        cam.title,
        cam.title,
        tuple(m.quantity for m in chosen),
        np.array([m.value for m in chosen]),
        tuple(figures),
        np.array(values),
        np.array(slopes).reshape(len(figures), len(chosen)),
        notes=tuple(notes),
    )


def _found(
    cam: CamFile,
    sized: tuple[str, float],
    theta: float,
    moved: Sequence[CamFile],
    scales: Floats,
) -> tuple[float, Floats, bool]:
    """Return a column at an angle, its derivatives, not numbers at a corner, and whether it is.

    The column is given with its largest size. Derivatives are by measures with sizes ``scales``,
    which ``moved`` step into the complex plane.
    """
    column, size = sized
    angles = theta + _BESIDE * np.array([0.0, -1.0, 1.0])
    value = float(cam_columns(cam, angles[:1])[column].values[0])
    slopes = [np.imag(cam_columns(other, angles)[column].values) / _STEP for other in moved]
    rows, sizes = np.array(slopes).reshape(len(moved), len(angles)), scales[:, None]
    largest = float(np.max(np.abs(rows * sizes), initial=0.0))
    apart = np.abs(rows[:, 1] - rows[:, 2]) * sizes[:, 0]
    lost = (apart > np.maximum(_CORNER * largest, _NEGLIGIBLE * size)) | ~np.isfinite(rows).all(
        axis=1
    )
    return value, np.where(lost, np.nan, rows[:, 0]), bool(lost.any())


def _largest(values: Floats) -> float:
    """Return the largest size of finite values."""
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))


def _extreme(cam: CamFile, kind: str, column: str) -> float:
    theta = cam.samples(max(cam.steps, _FEWEST))[:-1]
    values = np.asarray(cam_columns(cam, theta)[column].values)
    if kind == "peak":
        values = np.abs(values)
    k = int(np.argmin(values) if kind == "min" else np.argmax(values))
    step = float(theta[1] - theta[0])
    grown = (values[k - 1], values[(k + 1) % len(theta)])
    if not np.isfinite([*grown, values[k]]).all() or values[k] in grown:
        return float(theta[k])
    from scipy.optimize import minimize_scalar

    def size(angle: float) -> float:
        value = float(cam_columns(cam, np.array([angle]))[column].values[0])
        return value if kind == "min" else -abs(value) if kind == "peak" else -value

    ends = theta[k] - step, theta[k] + step
    found = minimize_scalar(size, bounds=ends, method="bounded", options={"xatol": 1e-12})
    return float(found.x if found.fun <= size(float(theta[k])) else theta[k])


def _measures(cam: CamFile) -> Iterator[_Measure]:
    """Yield the numbers that may move: what comes later in the turn moves along.

    The last law takes what is left of the turn, and the last one that rises or falls closes it. An
    outline of arcs stays as it is and moves as a whole, since a single arc would open it.
    """
    if cam.base_radius is not None:
        yield _measure(cam, ("base_radius",), "base_radius")
    yield from _numbers(cam.follower, ("follower",))
    if cam.conjugate is not None:
        yield from _numbers(cam.conjugate, ("conjugate",))
        yield from _numbers(cam.conjugate.follower, ("conjugate", "follower"))
    if cam.outline is not None and not isinstance(cam.outline, MeasuredPoints):
        yield from _numbers(cam.outline, ("outline",))
    if isinstance(cam.outline, Arcs):
        for k, axis in enumerate("xy"):
            about = Quantity(f"outline.start.{axis}", "m", f"Where the first arc starts, {axis}")
            yield _Measure(about, cam.outline.start[k], ((("outline", "start", k), 1.0),))
    if cam.load is not None:
        yield from _numbers(cam.load, ("load",))
    laws = cam.laws
    rises = [k for k, law in enumerate(laws) if law.rise]
    for k, law in enumerate(laws):
        if k < len(laws) - 1:
            yield _measure(law, ("motion", k, "over"), f"motion.{k + 1}.over")
        if law.rise and k != rises[-1]:
            field = "swing" if law.turns else "lift"
            closing = ("motion", rises[-1], field), -1.0
            yield _measure(law, ("motion", k, field), f"motion.{k + 1}.{field}", closing)


def _numbers(owner: ParameterSet, place: tuple[str | int, ...]) -> Iterator[_Measure]:
    """Yield the numbers of a part, by their places."""
    for field in type(owner).model_fields:
        if isinstance(getattr(owner, field), float):
            yield _measure(owner, (*place, field), ".".join(map(str, (*place, field))))


def _measure(
    owner: ParameterSet,
    place: tuple[str | int, ...],
    name: str,
    *further: tuple[tuple[str | int, ...], float],
) -> _Measure:
    field = str(place[-1])
    about = type(owner).model_fields[field].description or name
    quantity = Quantity(name, field_unit(type(owner), field) or "1", about)
    return _Measure(quantity, float(getattr(owner, field)), ((place, 1.0), *further))


def _moved(cam: CamFile, measure: _Measure, lowest_at: float | None) -> CamFile:
    """Return a cam with a step of a measure into the complex plane.

    ``lowest_at`` is the angle of the least coordinate, of an outline [rad].
    """
    own: dict[str, Any] = {name: getattr(cam, name) for name in type(cam).model_fields}
    for (first, *rest), share in measure.places:
        own[str(first)] = _stepped(own[str(first)], rest, 1j * share * _STEP)
    found = type(cam).model_construct(**own)
    return found if lowest_at is None else found.with_lowest_at(lowest_at)


def _stepped(part: Any, place: Sequence[str | int], step: complex) -> Any:
    """Return a part with a step of the number at a place in it."""
    if not place:
        return part + step
    first, *rest = place
    if isinstance(first, int):
        items = list(part)
        items[first] = _stepped(items[first], rest, step)
        return type(part)(items)
    return part.model_copy(update={first: _stepped(getattr(part, first), rest, step)})


def _parsed(name: str) -> tuple[str, str, tuple[float, ...]]:
    """Return what a name asks for: kind of extreme or "", column, angles [rad].

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    parts, _ = called_parts(name, _FORM, (1, 2), ())
    match = _EXTREME.fullmatch(parts[0])
    if (match is None) == (len(parts) == 1):
        raise InputError(f"'{name}': write {_FORM}")
    if match is not None:
        return match[1], match[2], ()
    try:
        return "", parts[0], tuple(read_range(parts[1]).values("rad"))
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
