"""Key figures in the file of a table: names as a scale, with values, units and meanings."""

from __future__ import annotations

from collections.abc import Iterable

import h5py
import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    read_quantities,
    write_numbers,
    write_quantities,
)


def write_key_figures(file: h5py.File, figures: Iterable[tuple[Quantity, float]]) -> None:
    """Write figures with their values in SI."""
    found = list(figures)
    scale = write_quantities(file, "figure", tuple(quantity for quantity, _ in found))
    values = np.array([value for _, value in found], dtype=float)
    write_numbers(file, "figure_value", values, (scale,), ("", "Value of the key figure"))


def read_key_figures(file: h5py.File) -> list[tuple[Quantity, float]]:
    """Return figures with their values in SI; none of a file without them."""
    if "figure" not in file:
        return []
    figures, sizes = read_quantities(file, "figure"), Sizes()
    sizes.count("figure", figures, "figures")
    values = sizes.read(file, "figure_value", "figures", infinite=True)
    return list(zip(figures, map(float, values), strict=True))
