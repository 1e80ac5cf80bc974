"""Profiles of cams for milling machines: drawings in DXF (R12), points in CSV.

R12 (AC1009) is the oldest drawing that programs of machines read: lines of group codes, each with
its value, in sections HEADER, TABLES and ENTITIES.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.hdf5.output import write_failed

_CLOSED = 1
_COLOURS = {"PROFILE": 7, "PITCH": 3, "BASE": 8, "AXIS": 1, "PROFILE_2": 5, "PITCH_2": 4}


@dataclass(frozen=True)
class Path2:
    """A chain of points on a layer, shape (n, 2) [m], closed or open."""

    layer: str
    points: Any
    is_closed: bool = True


@dataclass(frozen=True)
class Circle2:
    """A circle on a layer [m]."""

    layer: str
    centre: tuple[float, float]
    radius: float


def write_profile(path: Path, items: Sequence[Path2 | Circle2]) -> None:
    """Write a drawing in mm as DXF, or the points of its profiles as CSV, by the name's ending.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    lines = _csv(items) if path.suffix.lower() == ".csv" else _dxf(items)
    try:
        with whole_file(path) as place:
            place.write_text("".join(f"{line}\n" for line in lines), encoding="ascii")
    except OSError as error:
        raise write_failed(path, error) from error


def _csv(items: Sequence[Path2 | Circle2]) -> Iterator[str]:
    paths = [i for i in items if isinstance(i, Path2) and i.layer.startswith("PROFILE")]
    yield ",".join(["x [mm],y [mm]", "second x [mm],second y [mm]"][: len(paths)])
    for row in zip(*(path.points for path in paths), strict=True):
        yield ",".join(f"{1e3 * x:.9f},{1e3 * y:.9f}" for x, y in row)


def _dxf(items: Sequence[Path2 | Circle2]) -> Iterator[str]:
    layers = list(dict.fromkeys(item.layer for item in items))
    for code, value in _groups(items, layers):
        yield f"{code:>3}"
        yield value if isinstance(value, str) else _number(value)


def _all(*pairs: tuple[int, str | int | float]) -> Iterator[tuple[int, str | int | float]]:
    yield from pairs


def _number(value: int | float) -> str:
    return f"{value:6d}" if isinstance(value, int) else f"{value:.9f}"


def _groups(
    items: Sequence[Path2 | Circle2], layers: Sequence[str]
) -> Iterator[tuple[int, str | int | float]]:
    low, high = _extent(items)
    yield from _all((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"))
    yield from _all((9, "$EXTMIN"), (10, low[0]), (20, low[1]), (30, 0.0))
    yield from _all((9, "$EXTMAX"), (10, high[0]), (20, high[1]), (30, 0.0), (0, "ENDSEC"))
    yield from _all((0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE"), (70, 1))
    yield from _all((0, "LTYPE"), (2, "CONTINUOUS"), (70, 64), (3, "Solid line"), (72, 65))
    yield from _all(
        (73, 0), (40, 0.0), (0, "ENDTAB"), (0, "TABLE"), (2, "LAYER"), (70, len(layers))
    )
    for layer in layers:
        yield from _all((0, "LAYER"), (2, layer), (70, 0), (62, _COLOURS.get(layer, 7)))
        yield 6, "CONTINUOUS"
    yield from _all((0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))
    for item in items:
        yield from _circle(item) if isinstance(item, Circle2) else _polyline(item)
    yield from _all((0, "ENDSEC"), (0, "EOF"))


def _circle(item: Circle2) -> Iterator[tuple[int, str | int | float]]:
    yield from _all((0, "CIRCLE"), (8, item.layer))
    yield from _all((10, 1e3 * item.centre[0]), (20, 1e3 * item.centre[1]), (30, 0.0))
    yield 40, 1e3 * item.radius


def _polyline(item: Path2) -> Iterator[tuple[int, str | int | float]]:
    yield from _all((0, "POLYLINE"), (8, item.layer), (66, 1), (10, 0.0), (20, 0.0), (30, 0.0))
    yield 70, _CLOSED if item.is_closed else 0
    for x, y in item.points:
        yield from _all((0, "VERTEX"), (8, item.layer))
        yield from _all((10, 1e3 * float(x)), (20, 1e3 * float(y)), (30, 0.0))
    yield from _all((0, "SEQEND"), (8, item.layer))


def _extent(items: Sequence[Path2 | Circle2]) -> tuple[tuple[float, float], tuple[float, float]]:
    xs, ys = [], []
    for item in items:
        if isinstance(item, Circle2):
            xs += [item.centre[0] - item.radius, item.centre[0] + item.radius]
            ys += [item.centre[1] - item.radius, item.centre[1] + item.radius]
        else:
            xs += [float(item.points[:, 0].min()), float(item.points[:, 0].max())]
            ys += [float(item.points[:, 1].min()), float(item.points[:, 1].max())]
    return (1e3 * min(xs), 1e3 * min(ys)), (1e3 * max(xs), 1e3 * max(ys))
