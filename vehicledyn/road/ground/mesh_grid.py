"""Meshes of triangles seen from above, as heights on a square grid."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.road.ground.height_grid import (
    MOST_NODES,
    Array,
    HeightGrid,
    height_of,
    number_of,
    text_lines,
)


def grid_of_mesh(path: Path, step: float) -> HeightGrid:
    """Return the heights of a mesh seen from above, on a grid with a given step [m].

    Parameters
    ----------
    path
        Wavefront OBJ file with z upwards; faces with more corners are cut into triangles.
    step
        Distance of the nodes [m].

    Raises
    ------
    InputError
        If the file has no faces, is wrong, or leaves nodes inside its outline without ground.
    """
    vertices, triangles = _read_obj(path)
    corners = vertices[triangles]
    low, high = corners[..., :2].min((0, 1)), corners[..., :2].max((0, 1))
    shape = tuple(int(n) + 1 for n in np.floor((high - low) / step + 1e-9))
    if min(shape) < 2 or shape[0] * shape[1] > MOST_NODES:
        raise InputError(
            f"{path}: a mesh of {high[0] - low[0]:g} m by {high[1] - low[1]:g} m needs another "
            f"cell than {step:g} m: two nodes each way at least, {MOST_NODES} in all at most"
        )
    heights = np.full(shape, -np.inf)
    for corner in corners:
        _cover(heights, corner, low, step)
    if not np.isfinite(heights).all():
        i, j = np.argwhere(~np.isfinite(heights))[0]
        raise InputError(
            f"{path}: no triangle lies above or below x = {low[0] + i * step:g} m, "
            f"y = {low[1] + j * step:g} m; the mesh must cover the rectangle around it"
        )
    return HeightGrid(float(low[0]), float(low[1]), step, heights)


def _cover(heights: Array, corner: Array, low: Array, step: float) -> None:
    """Raise the nodes under a triangle to it."""
    places = (corner[:, :2] - low) / step
    first = np.maximum(np.ceil(places.min(0) - 1e-9).astype(int), 0)
    last = np.minimum(np.floor(places.max(0) + 1e-9).astype(int) + 1, heights.shape)
    sides = places[1:] - places[0]
    area = sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]
    if area == 0.0 or (first >= last).any():
        return
    i, j = np.meshgrid(*(np.arange(a, b) for a, b in zip(first, last, strict=True)), indexing="ij")
    dx, dy = i - places[0, 0], j - places[0, 1]
    second = (dx * sides[1, 1] - dy * sides[1, 0]) / area
    third = (dy * sides[0, 0] - dx * sides[0, 1]) / area
    z = (
        corner[0, 2]
        + second * (corner[1, 2] - corner[0, 2])
        + third * (corner[2, 2] - corner[0, 2])
    )
    inside = (second >= -1e-9) & (third >= -1e-9) & (second + third <= 1.0 + 1e-9)
    part = heights[first[0] : last[0], first[1] : last[1]]
    part[inside] = np.maximum(part[inside], z[inside])


def _read_obj(path: Path) -> tuple[Array, NDArray[np.intp]]:
    vertices: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for number, line in enumerate(text_lines(path), 1):
        words = line.split()
        if words[:1] == ["v"]:
            if len(words) < 4:
                raise InputError(f"{path}:{number}: a vertex needs three numbers")
            place = [number_of(path, number, word) for word in words[1:3]]
            vertices.append([*place, height_of(path, number, words[3])])
        elif words[:1] == ["f"]:
            face = [_corner(path, number, word, len(vertices)) for word in words[1:]]
            if len(face) < 3:
                raise InputError(f"{path}:{number}: a face needs three corners")
            triangles += [(face[0], a, b) for a, b in pairwise(face[1:])]
    if not triangles:
        raise InputError(f"{path}: has no faces; a mesh is a Wavefront OBJ file (lines v and f)")
    return np.array(vertices), np.array(triangles, dtype=np.intp)


def _corner(path: Path, number: int, word: str, known: int) -> int:
    try:
        index = int(word.split("/", maxsplit=1)[0])
    except ValueError:
        raise InputError(f"{path}:{number}: '{word[:40]}' is no corner of a face") from None
    index = index - 1 if index > 0 else known + index
    if not 0 <= index < known:
        raise InputError(
            f"{path}:{number}: there is no vertex {word.split('/', maxsplit=1)[0]} yet"
        )
    return index
