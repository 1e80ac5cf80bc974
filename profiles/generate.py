"""Write the standard profiles as tables: run `python profiles/generate.py` in this folder's parent.

The numbers they are built from stand in vehicledyn/rail/profiles, each with its source.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.profile import Profile

STEP = 0.5  # mm
TABLES = (("s1002", "S1002", "wheel"), ("60e1", "60E1", "rail"))
MEANING = {
    "wheel": "outwards from the tape circle, z increase of the radius over that of the tape circle",
    "rail": "outwards from the axis of the upright rail, z height over the crown",
}


def text_of(profile: Profile) -> str:
    """Return a profile as a table in mm, places where its pieces meet among its rows."""
    ends = [1e3 * piece.begin for piece in profile.pieces] + [1e3 * profile.end]
    even = np.arange(np.ceil(ends[0] / STEP), np.floor(ends[-1] / STEP) + 1.0) * STEP
    places = np.unique(np.round(np.concatenate([ends, even]), 6))
    heights = 1e3 * profile.height(1e-3 * places)
    head = (
        f"# source: {' '.join(profile.source.split())}\n"
        f"# derived: by profiles/generate.py from the numbers in vehicledyn/rail/profiles\n"
        f"# axes: y {MEANING[profile.kind]}\n"
        "# unit: mm\n# licence: facts of a standard, free to use\n"
        "y_mm,z_mm\n"
    )
    return head + "".join(f"{y:.6f},{z:.7f}\n" for y, z in zip(places, heights, strict=True))


if __name__ == "__main__":
    for stem, name, kind in TABLES:
        profile = named_profile(name, "wheel" if kind == "wheel" else "rail")
        Path(__file__).with_name(f"{stem}.csv").write_text(text_of(profile), encoding="utf-8")
