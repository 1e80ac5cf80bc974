"""OpenCRG roads evaluated: places, heights, headings and curvatures, as the file's options say.

Numbers agree with the C library of ASAM OpenCRG 1.2 (``evaluv2z``, ``evalxy2uv``, ``evaluv2xy``,
``evaluv2pk``); heights are kept in single precision, as there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.road.opencrg.data import CrgData, read_crg
from vehicledyn.road.opencrg.line import ReferenceLine, reference_heights, reference_line
from vehicledyn.road.opencrg.modifiers import DEFAULTS, scaled
from vehicledyn.road.opencrg.payload import Array, Flags, Indices


class Border(IntEnum):
    """What lies beyond the grid: nothing, zero, the last height, the road again or mirrored."""

    NONE = 0
    ZERO = 1
    KEEP = 2
    REPEAT = 3
    REFLECT = 4


@dataclass(frozen=True)
class Borders:
    """Borders of a road along u and v, offsets beyond them and smooth ends [m]."""

    u: Border = Border.KEEP
    v: Border = Border.KEEP
    offset_u: float = 0.0
    offset_v: float = 0.0
    smooth_start: float = 0.0
    smooth_end: float = 0.0


@dataclass(frozen=True, eq=False)
class CrgRoad:
    """A curved regular grid that can be asked for places and heights.

    All methods take arrays of any equal shape, or numbers, and return arrays of that shape.

    Parameters
    ----------
    line
        The reference line.
    v
        Places of the long sections, growing [m].
    edges
        Right and left edge, as the header has them [m].
    heights
        Over the reference line, shape (n_u, n_v) [m].
    rise
        Heights of the reference line, shape (n_u,), or one for all [m].
    bank
        Cross slope, shape (n_u,), or one for all [1].
    lift
        Added to all heights but those of a zero border [m].
    borders
        What lies beyond the grid.
    is_even
        Whether long sections are numbered: a repeated border then repeats the bank too.
    missing
        Where the file has no height, shape (n_u, n_v), or None; heights may be filled there.
    """

    line: ReferenceLine
    v: Array
    edges: tuple[float, float]
    heights: NDArray[np.float32]
    rise: Array | float
    bank: Array | float
    lift: float
    borders: Borders
    is_even: bool
    missing: Flags | None = None

    @staticmethod
    def read(
        path: Path,
        *,
        modifiers: dict[str, float] | None = None,
        move: dict[str, float] | None = None,
    ) -> CrgRoad:
        """Return the road of a file.

        Parameters
        ----------
        path
            The file.
        modifiers
            Modifiers in place of the file's; an empty dict for none.
        move
            Modifiers that place the road, in place of those that do so now.

        Raises
        ------
        InputError
            If the file cannot be read or is no road; with line.
        """
        data = read_crg(path)
        if modifiers is None:
            modifiers = data.modifiers if data.has_modifiers else DEFAULTS
        if move is not None:
            kept = {n: v for n, v in modifiers.items() if not n.startswith("ref")}
            modifiers = {**kept, **move}
        return road_of(data, modifiers)

    def place(self, u: Array | float, v: Array | float) -> tuple[Array, Array]:
        """Return x and y [m] of places on the road [m]."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        return self.line.place(u, v)

    def road_place(self, x: Array | float, y: Array | float) -> tuple[Array, Array]:
        """Return u and v [m] of places in the world [m]."""
        x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        return self.line.road_place(x, y)

    def heading_and_curvature(self, u: Array | float, v: Array | float) -> tuple[Array, Array]:
        """Return heading [rad] and curvature [1/m] of places on the road [m]."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        return self.line.heading_and_curvature(u, v)

    def height(self, u: Array | float, v: Array | float) -> Array:
        """Return heights [m] of places on the road [m]; NaN where the road has none."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        u = self.line.wrapped(u) if self.line.closed else u
        start, stop = self.line.start, self.line.stop
        beyond_u = (u < start) | (u > stop)
        along = np.where(beyond_u, _folded(u, start, stop, self.borders.u), u)
        index, part = self._cross_section(along)
        column, share, side, beyond_v = self._long_section(v)
        height = self._on_grid(index, part, column, share)
        height = height + _interpolated(self.rise, index, part)
        height = height + _interpolated(self.bank, index, part) * side
        height = self._beyond(height, beyond_u, beyond_v)
        return self._smoothed(height, along)

    def covers(self, x: Array | float, y: Array | float) -> Flags:
        """Return whether places [m] lie on the grid, or where its borders repeat it."""
        u, v = self.road_place(x, y)
        goes_on = (Border.REPEAT, Border.REFLECT)
        (right, left), of = self.edges, self.borders
        along = (u >= self.line.start) & (u <= self.line.stop)
        along |= np.bool_(self.line.closed or of.u in goes_on)
        across = (v >= right) & (v <= left)
        across |= np.bool_(of.v in goes_on)
        return np.asarray(along & across)

    def lacks(self, x: Array | float, y: Array | float) -> Flags:
        """Return whether heights of places [m] rest on one that the file does not have.

        A place counts where it lies on the grid and one of the nodes whose heights are
        interpolated there, with a share above zero, is missing.
        """
        u, v = self.road_place(x, y)
        if self.missing is None:
            return np.zeros(np.shape(u), dtype=bool)
        u = self.line.wrapped(u) if self.line.closed else u
        index, part = self._cross_section(np.clip(u, self.line.start, self.line.stop))
        column, share, _, _ = self._long_section(np.clip(v, *self.edges))
        near, far = (
            (self.missing[index + i, column] & (share < 1.0))
            | (self.missing[index + i, column + 1] & (share > 0.0))
            for i in (0, 1)
        )
        return np.asarray((near & (part < 1.0)) | (far & (part > 0.0)))

    def gaps(self) -> str:
        """Return how many heights the file lacks and where the first is; empty for none."""
        if self.missing is None:
            return ""
        row, column = np.argwhere(self.missing)[0]
        count, u = int(self.missing.sum()), self.line.start + row * self.line.step
        words = "height is" if count == 1 else "heights are"
        return (
            f"{count} of {self.missing.size} {words} missing, the first at "
            f"u = {u:.6g} m, v = {self.v[column]:.6g} m"
        )

    def height_at(self, x: Array | float, y: Array | float) -> Array:
        """Return heights [m] of places in the world [m]; NaN where the road has none."""
        return self.height(*self.road_place(x, y))

    def _cross_section(self, u: Array) -> tuple[Indices, Array]:
        place = np.maximum((u - self.line.start) / self.line.step, 0.0)
        index = np.floor(place).astype(np.intp)
        most = len(self.heights) - 2
        return np.minimum(index, most), np.where(index > most, 1.0, place - index)

    def _long_section(self, v: Array) -> tuple[Indices, Array, Array, Flags]:
        """Return number and share of the cell, the v that the bank counts, and what is beyond."""
        right, left = self.edges
        near = 0.0 if self.is_even else 1e-8
        beyond = (v < right - near) | (v > left + near)
        folded = np.where(beyond, _folded(v, right, left, self.borders.v), v)
        column = np.clip(np.searchsorted(self.v, folded, side="right") - 1, 0, len(self.v) - 2)
        share = (folded - self.v[column]) / (self.v[column + 1] - self.v[column])
        side = np.clip(folded if self.is_even else v, right, left)
        return column, np.clip(share, 0.0, 1.0), side, beyond

    def _on_grid(self, index: Indices, part: Array, column: Indices, share: Array) -> Array:
        z00, z01, z10, z11 = (
            np.asarray(self.heights[index + i, column + k], dtype=float)
            for i in (0, 1)
            for k in (0, 1)
        )
        near, far = z00 + (z01 - z00) * share, z10 + (z11 - z10) * share
        return np.asarray(near + (far - near) * part + self.lift)

    def _beyond(self, height: Array, beyond_u: Flags, beyond_v: Flags) -> Array:
        """Return heights with the borders' rules; along u they come first."""
        of = self.borders
        offset = np.where(beyond_u, of.offset_u, 0.0) + np.where(beyond_v, of.offset_v, 0.0)
        outside = (Border.ZERO, Border.KEEP)
        by_u = beyond_u & np.bool_(of.u in outside)
        for where, mode in ((by_u, of.u), (beyond_v & np.bool_(of.v in outside) & ~by_u, of.v)):
            changed = offset if mode is Border.ZERO else height + offset
            height = np.where(where, changed, height)
        nothing = (beyond_u & np.bool_(of.u is Border.NONE)) | (
            beyond_v & np.bool_(of.v is Border.NONE)
        )
        return np.where(nothing, np.nan, height)

    def _smoothed(self, height: Array, u: Array) -> Array:
        """Return heights led to those of the reference line at the ends of the road."""
        first, last = (self.rise, self.rise) if isinstance(self.rise, float) else self.rise[[0, -1]]
        for zone, into, base in (
            (self.borders.smooth_start, u - self.line.start, first),
            (self.borders.smooth_end, self.line.stop - u, last),
        ):
            if zone > 0.0:
                scale = np.clip(into / zone, 0.0, 1.0)
                height = np.where(into <= zone, base + (height - base) * scale, height)
        return height


def _folded(at: Array, low: float, high: float, border: Border) -> Array:
    """Return places brought back between two edges by a repeating or reflecting border."""
    size = high - low
    if border is Border.REPEAT:
        return low + np.mod(at - low, size)
    if border is Border.REFLECT:
        return low + size - abs(np.mod(at - low, 2.0 * size) - size)
    return at


def _interpolated(values: Array | float, index: Indices, part: Array) -> Array | float:
    if isinstance(values, float):
        return values
    return values[index] + np.clip(part, 0.0, 1.0) * (values[index + 1] - values[index])


def road_of(data: CrgData, modifiers: dict[str, float]) -> CrgRoad:
    """Return the road of data after modifiers.

    Raises
    ------
    InputError
        If modifiers or options contradict each other.
    """
    _check(data, modifiers)
    missing = np.isnan(data.heights)
    changed = scaled(data, modifiers)
    heights = reference_heights(changed)
    banks = [changed.setting(f"reference_line_{end}_b") for end in ("start", "end")]
    bank: Array | float = banks[0]
    if changed.bank is not None:
        bank = changed.bank
    road = CrgRoad(
        reference_line(changed),
        changed.v,
        _edges(changed),
        changed.heights,
        changed.setting("reference_line_start_z") if heights is None else heights,
        bank,
        0.0,
        _borders(data.options),
        changed.is_even,
        missing if missing.any() else None,
    )
    return _moved(road, modifiers)


def _edges(data: CrgData) -> tuple[float, float]:
    names = ("long_section_v_right", "long_section_v_left")
    first, last = float(data.v[0]), float(data.v[-1])
    right, left = (data.settings.get(n, d) for n, d in zip(names, (first, last), strict=True))
    return (right, left) if right < left else (first, last)


def _borders(options: dict[str, float]) -> Borders:
    return Borders(
        Border(int(options.get("border_mode_u", Border.KEEP))),
        Border(int(options.get("border_mode_v", Border.KEEP))),
        options.get("border_offset_u", 0.0),
        options.get("border_offset_v", 0.0),
        options.get("border_smooth_ubeg", 0.0),
        options.get("border_smooth_uend", 0.0),
    )


def _moved(road: CrgRoad, modifiers: dict[str, float]) -> CrgRoad:
    """Return the road at the place that modifiers give it."""
    by_point = any(
        name.startswith("refpoint_") and not name.endswith("_offset") for name in modifiers
    )
    if by_point:
        return _moved_by_point(road, modifiers)
    offsets = {n: modifiers.get(f"refline_offset_{n}") for n in ("x", "y", "z", "phi")}
    if all(value is None for value in offsets.values()):
        return road
    line = road.line
    centre = (
        modifiers.get("refline_rotcenter_x", float(line.x[0])),
        modifiers.get("refline_rotcenter_y", float(line.y[0])),
    )
    x, y, z, angle = (offsets[n] or 0.0 for n in ("x", "y", "z", "phi"))
    return _lifted(replace(road, line=line.moved(angle, centre, (x, y))), z)


def _moved_by_point(road: CrgRoad, modifiers: dict[str, float]) -> CrgRoad:
    line = road.line
    u = modifiers.get("refpoint_u", line.start)
    if "refpoint_u_fraction" in modifiers:
        share = modifiers["refpoint_u_fraction"]
        u = line.start + share * (line.stop - line.start) + modifiers.get("refpoint_u_offset", 0.0)
    v = modifiers.get("refpoint_v", 0.0)
    if "refpoint_v_fraction" in modifiers:
        right, left = road.edges
        share = modifiers["refpoint_v_fraction"]
        v = right + share * (left - right) + modifiers.get("refpoint_v_offset", 0.0)
    x, y = (float(value) for value in road.place(u, v))
    height = float(road.height(u, v))
    heading = float(road.heading_and_curvature(u, v)[0])
    to_x, to_y, to_z, to_phi = (modifiers.get(f"refpoint_{n}", 0.0) for n in ("x", "y", "z", "phi"))
    moved = line.moved(to_phi - heading, (x, y), (to_x - x, to_y - y))
    lift = to_z - (0.0 if math.isnan(height) else height)
    return _lifted(replace(road, line=moved), lift)


def _lifted(road: CrgRoad, by: float) -> CrgRoad:
    if isinstance(road.rise, float):
        return replace(road, lift=road.lift + by)
    return replace(road, rise=road.rise + by)


def _check(data: CrgData, modifiers: dict[str, float]) -> None:
    """Refuse options and modifiers that have no meaning together."""
    for name, numbers, most in (
        ("border_mode_u", data.options, 4),
        ("border_mode_v", data.options, 4),
        ("refline_continuation", data.options, 1),
        ("grid_nan_mode", modifiers, 2),
    ):
        value = numbers.get(name, 0.0)
        if value not in range(most + 1):
            raise InputError(_at(data, name, f"must be a whole number from 0 to {most}"))
    for name in ("scale_length", "scale_width"):
        if not modifiers.get(name, 1.0) > 0.0:
            raise InputError(_at(data, name, "must be positive"))
    for name in ("border_smooth_ubeg", "border_smooth_uend"):
        if data.options.get(name, 0.0) < 0.0:
            raise InputError(_at(data, name, "must not be negative"))
    for axis in ("u", "v"):
        if {f"refpoint_{axis}", f"refpoint_{axis}_fraction"} <= set(modifiers):
            words = f"give either this or refpoint_{axis}_fraction"
            raise InputError(_at(data, f"refpoint_{axis}", words))


def _at(data: CrgData, name: str, words: str) -> str:
    line = data.lines.get(name)
    return ": ".join((f"{data.source}:{line}" if line else data.source, name, words))
