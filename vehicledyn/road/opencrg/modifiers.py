"""Modifiers of OpenCRG roads: scaling, missing heights, another place or heading.

Order and meaning follow the reference library of ASAM OpenCRG: scaling, missing heights, then
the move, by a reference point on the road or else by offsets.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.road.opencrg.data import CrgData

DEFAULTS = {"grid_nan_mode": 2.0, "refpoint_u_fraction": 0.0, "refpoint_v_fraction": 0.0}
"""What applies to a file without modifiers: close gaps; put the first right corner at zero."""

AT_REFERENCE_LINE = {"refpoint_u_fraction": 0.0, "refpoint_v": 0.0}
"""The start of the reference line at zero, running along x."""

KEEP_NAN, ZERO_NAN, NEIGHBOUR_NAN = 0, 1, 2


def scaled(data: CrgData, modifiers: dict[str, float]) -> CrgData:
    """Return the data scaled and with missing heights filled as modifiers say."""
    settings = dict(data.settings)
    result = replace(data, settings=settings)
    if "scale_z_grid" in modifiers:
        result.heights = data.heights * np.float32(modifiers["scale_z_grid"])
    if "scale_slope" in modifiers:
        _scale_slope(result, modifiers["scale_slope"])
    if "scale_banking" in modifiers:
        _scale_bank(result, modifiers["scale_banking"])
    if "scale_length" in modifiers:
        result.step = data.step * modifiers["scale_length"]
        for name in ("x", "y", "z"):
            settings.pop(f"reference_line_end_{name}", None)
    if "scale_width" in modifiers:
        result.v = data.v * modifiers["scale_width"]
        for name in ("right", "left", "increment"):
            key = f"long_section_v_{name}"
            if key in settings:
                settings[key] *= modifiers["scale_width"]
    if "scale_curvature" in modifiers:
        _scale_curvature(result, modifiers["scale_curvature"])
    mode = int(modifiers.get("grid_nan_mode", KEEP_NAN))
    if "grid_nan_offset" in modifiers and "grid_nan_mode" not in modifiers:
        mode = NEIGHBOUR_NAN
    if mode != KEEP_NAN:
        result.heights = filled(result.heights, mode, modifiers.get("grid_nan_offset", 0.0))
    return result


def _scale_slope(data: CrgData, factor: float) -> None:
    if data.slope is not None:
        data.slope = data.slope * factor
    for end in ("start", "end"):
        key = f"reference_line_{end}_s"
        if key in data.settings:
            data.settings[key] *= factor
    data.settings.pop("reference_line_end_z", None)


def _scale_bank(data: CrgData, factor: float) -> None:
    if data.bank is not None:
        data.bank = data.bank * factor
    for end in ("start", "end"):
        key = f"reference_line_{end}_b"
        if key in data.settings:
            data.settings[key] *= factor


def _scale_curvature(data: CrgData, factor: float) -> None:
    first = data.setting("reference_line_start_phi")
    if data.heading is not None:
        data.heading = first + factor * (data.heading - first)
        data.settings["reference_line_end_phi"] = float(data.heading[-1])
    else:
        data.settings["reference_line_end_phi"] = first
    for name in ("x", "y"):
        data.settings.pop(f"reference_line_end_{name}", None)


def filled(heights: NDArray[np.float32], mode: int, offset: float) -> NDArray[np.float32]:
    """Return heights without gaps: zero, or the value of the neighbour towards the middle.

    Parameters
    ----------
    heights
        Shape (n_u, n_v) [m]; a cross section without any height keeps its gaps.
    mode
        1 for zero, 2 for the neighbour.
    offset
        Added once on either side of a cross section to what fills a gap [m].
    """
    result = heights.copy()
    for index in np.flatnonzero(np.isnan(result).any(axis=1)):
        _fill_row(result[index], mode, np.float32(offset))
    return result


def _fill_row(row: NDArray[np.float32], mode: int, offset: np.float32) -> None:
    for places, neighbour in ((range(1, len(row)), -1), (range(len(row) - 2, -1, -1), 1)):
        is_offset = False
        for at in places:
            value = row[at + neighbour]
            if not np.isnan(row[at]) or (neighbour == 1 and np.isnan(value)):
                continue
            if mode == ZERO_NAN:
                row[at] = offset
                continue
            row[at] = value
            if not np.isnan(value) and not is_offset:
                row[at] += offset
                is_offset = True
