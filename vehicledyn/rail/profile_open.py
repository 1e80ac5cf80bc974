"""Profiles by name or from a file, ready for use."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from vehicledyn.rail.named_profiles import named_profile
from vehicledyn.rail.profile import Profile
from vehicledyn.rail.profile_files import read_points
from vehicledyn.rail.profile_names import Kind, is_name
from vehicledyn.rail.profile_pieces import Table
from vehicledyn.rail.profile_shape import in_our_axes
from vehicledyn.rail.profile_smoothing import smoothed


def open_profile(text: str, kind: Kind, smoothing: float = 0.0) -> Profile:
    """Return the profile of a wheel or a rail, by name or from a file.

    Parameters
    ----------
    text
        Name such as "S1002", "60E1", "cone:1/40", or a file.
    kind
        What is needed, "wheel" or "rail".
    smoothing
        Wavelength of which half is left on a profile from a file; zero for none [m].

    Raises
    ------
    InputError
        If there is no such profile, or what the file holds is none.
    """
    if is_name(text) or not (Path(text).suffix or Path(text).exists()):
        return named_profile(text, kind)
    return read_profile(Path(text), kind, smoothing)


def read_profile(path: Path, kind: Kind, smoothing: float = 0.0) -> Profile:
    """Return the profile in a file, turned into the axes of this program.

    Raises
    ------
    InputError
        If it cannot be read or is no profile; the text names file and line.
    """
    y, z, notes = in_our_axes(read_points(path), kind)
    curve = smoothed(y, z, smoothing)
    if smoothing > 0.0:
        notes.append(
            f"smoothed over {1e3 * smoothing:g} mm: points lie up to {1e3 * curve.largest:.2g} mm "
            f"from the curve, {1e3 * curve.rms:.2g} mm in the root mean square"
        )
    shifted, said = _with_datum(curve.table, kind)
    return Profile(path.stem, kind, (shifted,), str(path), (*notes, *said))


def _with_datum(curve: Table, kind: Kind) -> tuple[Table, list[str]]:
    """Return the curve with z = 0 at the tape circle of a wheel, on the crown of a rail."""
    heights = curve.height(curve.places)
    zero = float(curve.height(np.array(0.0))) if kind == "wheel" else float(np.max(heights))
    raised = np.array([[zero], [0.0], [0.0]])
    where = "tape circle" if kind == "wheel" else "highest point"
    said = [f"z shifted by {-1e3 * zero:.4g} mm to zero at the {where}"] if abs(zero) > 1e-6 else []
    return replace(curve, left=curve.left - raised, right=curve.right - raised), said
