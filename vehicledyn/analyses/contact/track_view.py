"""A railway track looked at: what equations take it for, along its chainage."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import START, Problem, refusal
from vehicledyn.base.slope_text import slope_text
from vehicledyn.base.yaml import read_yaml
from vehicledyn.files.scenario import is_system_file, load_scenario
from vehicledyn.rail.track.kinds.file import read_track
from vehicledyn.rail.track.track import Track
from vehicledyn.rail.track.track_set import TrackChoice
from vehicledyn.rail.track.track_tables import CurvedLine
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.track_table import TrackTable, write_track
from vehicledyn.symbolic import ops

GRAVITY = 9.81
"""Acceleration of free fall by which cant balances a curve [m/s²]."""

_ROWS = 25
_IN_PICTURES = 2000


@dataclass(frozen=True)
class TrackReport:
    """A table along the track with the file and the folder it was written to."""

    table: TrackTable
    output: Path | None = None
    plots: Path | None = None

    def as_text(self) -> str:
        """Return what the track is and its table, lines no closer than they can be read."""
        table = self.table
        names = [n for n in table.columns if n in ("s", "x", "y") or np.any(table[n])]
        stride = max(1, math.ceil(len(table["s"]) / (4 * _ROWS)))
        rows = [[_shown(table[n][k]) for n in names] for k in range(0, len(table["s"]), stride)]
        columns = zip(names, *rows, strict=True)
        widths = [max(10, 1 + max(map(len, column))) for column in columns]
        heads = ["".join(f"{n:>{w}}" for n, w in zip(names, widths, strict=True))]
        units = [f"[{table.columns[n].unit}]" for n in names]
        heads += ["".join(f"{u:>{w}}" for u, w in zip(units, widths, strict=True))]
        lines = [table.title, *table.facts, "", *heads]
        lines += ["".join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True)) for row in rows]
        lines += [f"written to {place}" for place in (self.output, self.plots) if place]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "title": self.table.title,
            "facts": list(self.table.facts),
            "columns": {
                name: {
                    "unit": column.unit,
                    "description": column.description,
                    "values": [float(v) for v in column.values],
                }
                for name, column in self.table.columns.items()
            },
        }


def _shown(value: float) -> str:
    return f"{0.0 if abs(value) < 5e-7 else value:.6g}"


def view_track(
    path: Path,
    *,
    every: float | None = None,
    speed: float | None = None,
    output: Path | None = None,
    plots: Path | None = None,
) -> TrackReport:
    """Return the track of a file along its chainage.

    Parameters
    ----------
    path
        File of a track, or a scenario or system that has one.
    every
        Distance of the lines [m]; about 25 lines if None.
    speed
        Speed for which the cant deficiency is reported [m/s].
    output, plots
        Table as CSV to write and folder of the figures; None for none.

    Raises
    ------
    InputError
        If the file has no track, or a file cannot be written.
    """
    track, kind = _track_of(path)
    first, last = track.ends
    step = _even(max(last - first, 1.0) / _ROWS) if every is None else every
    if not step > 0.0 or (last - first) / step > 1e6:
        raise InputError(
            f"{argument('every')}: {step:g} m does not go with a track of {last - first:g} m"
        )
    places = np.unique(np.append(np.arange(first, last, step), last))
    table = _table(path, track, kind, places, speed)
    if output is not None:
        write_track(table, output)
    if plots is not None:
        from vehicledyn.results.plots.picture_files import save_figures
        from vehicledyn.results.plots.track_figures import track_figures

        fine = np.linspace(first, last, max(_IN_PICTURES, len(places)))
        figures = list(track_figures(_table(path, track, kind, fine, speed)))
        if not figures:
            raise InputError(f"{path}: the track is straight and perfect; there is nothing to draw")
        save_figures(figures, plots, ("png", "svg"))
    return TrackReport(table, output, plots)


def _even(step: float) -> float:
    """Return the next of 1, 2, 5, 10, 20 ... and their tenths from a step on."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(power * k for k in (1.0, 2.0, 5.0, 10.0) if power * k >= step * (1.0 - 1e-9))


def _track_of(path: Path) -> tuple[Track, str]:
    """Return the track of a file, and its kind."""
    data = read_yaml(path).data
    if isinstance(data, dict) and "kind" in data and "title" not in data:
        chosen: Any = read_track(path)
    elif is_system_file(path):
        chosen = _of_system(path)
    else:
        loaded = load_scenario(path)
        chosen = loaded.scenario.track
        if chosen is None and loaded.written.file is not None:
            return _track_of(Path(loaded.written.path))
    if not isinstance(chosen, TrackChoice):
        words = "there is no track in this file; give it a section 'track' or another file"
        raise refusal([Problem(str(path), START, "track", words)], str(path))
    return chosen.track(path.parent), chosen.kind


def _of_system(path: Path) -> Any:
    from vehicledyn.files.system.read import read_system

    model, problems = read_system(path)
    if model is None:
        raise refusal(problems, str(path))
    return model.file.track


def _table(path: Path, track: Track, kind: str, places: Any, speed: float | None) -> TrackTable:
    s = ops.symbol("s")
    frame = track.frame(s)
    shifts = [ops.scalar(v) for side in ("left", "right") for v in track.rail_shift(side, s)]
    flat = [*(frame.position[k] for k in range(3)), ops.scalar(frame.stretch)]
    flat += [frame.rotation[1, 0], frame.rotation[0, 0], frame.rotation[2, 0], frame.rotation[2, 1]]
    evaluate = ops.numeric(
        [s], ops.column([*flat, frame.rotation[2, 2], track.line.curvature(s), *shifts])
    )
    rows = evaluate(np.asarray(places, dtype=float)[None, :])  # a column for each place
    x, y, z, _, sine, cosine, climb, across, up, bend, *rails = rows
    roll = np.arctan2(across, up)
    cant = -track.base * np.sin(roll)
    rise = np.sqrt(np.maximum(1.0 - climb**2, 1e-12))
    columns = {
        "s": Column("m", "Chainage", places),
        "x": Column("m", "Place of the centre line", x),
        "y": Column("m", "Place of the centre line", y),
        "z": Column("m", "Height of the centre line", z),
        "heading": Column(
            "deg", "Heading, to the left", np.degrees(np.unwrap(np.arctan2(sine, cosine)))
        ),
        "curvature": Column("1/km", "Curvature, seen from above", 1e3 * bend),
        "cant": Column("mm", "Height of the right rail over the left one", 1e3 * cant),
        "gradient": Column("permil", "Slope of the centre line", 1e3 * climb / rise),
        "left_lateral": Column("mm", "Left rail, shift to the left", 1e3 * rails[0]),
        "left_vertical": Column("mm", "Left rail, shift upwards", 1e3 * rails[1]),
        "right_lateral": Column("mm", "Right rail, shift to the left", 1e3 * rails[2]),
        "right_vertical": Column("mm", "Right rail, shift upwards", 1e3 * rails[3]),
    }
    if speed is not None:
        lacking = np.sign(bend) * (track.base * speed**2 * bend / GRAVITY - cant)
        columns["cant_deficiency"] = Column(
            "mm", f"Cant that a curve lacks at {3.6 * speed:g} km/h", 1e3 * lacking
        )
    return TrackTable(_title(path), tuple(_facts(track, kind)), columns)


def _title(path: Path) -> str:
    return f"Track of {path.name}"


def _facts(track: Track, kind: str) -> list[str]:
    slope = track.inclination_text or slope_text(track.inclination)
    lean = f"inclined {slope}" if track.inclination else "upright"
    facts = [
        f"{kind}, gauge {1e3 * track.gauge:g} mm, rails {track.rail} {lean}, cant over "
        f"{1e3 * track.base:g} mm"
    ]
    line = track.line
    if isinstance(line, CurvedLine):
        facts.append(
            f"{line.length:g} m long, {len(line.x.coefficients)} cells within "
            f"{line.error:.1e} m of the design"
        )
    else:
        facts.append("straight and level without end")
    return facts
