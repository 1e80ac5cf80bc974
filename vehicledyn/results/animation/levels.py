"""Colours of shapes by the value of a channel, such as the stress in a beam."""

from __future__ import annotations

import math

from vehicledyn.base.units import parse_unit
from vehicledyn.results.animation.scene import AnimatedScene

RAMP = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
"""Colours from nothing to the highest value (viridis), told apart in grey too."""

_SHOWN = {"Pa": "MPa"}


def level_colour(value: float, most: float) -> str:
    """Return the colour of a value between zero and the highest; grey of what is no number."""
    from matplotlib.colors import LinearSegmentedColormap, to_hex

    if not math.isfinite(value):
        return "#808080"
    ramp = LinearSegmentedColormap.from_list("levels", RAMP)
    return to_hex(ramp(min(abs(value) / most, 1.0) if most > 0.0 else 0.0))


def level_words(scene: AnimatedScene) -> str:
    """Return what the highest colour means, such as "stress 120 MPa"."""
    series = next(iter(scene.levels.values()))
    unit = _SHOWN.get(series.unit, series.unit)
    factor = parse_unit(series.unit).factor / parse_unit(unit).factor
    word = series.name.rpartition(".")[2].replace("_", " ")
    return f"{word} 0 to {factor * scene.highest_level:.3g} {unit}"
