"""Profiles by name or from a file, ready for use."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.profile import Profile, ProfileMeasurement
from vehicledyn.rail.profiles.profile_defects import find_scatter
from vehicledyn.rail.profiles.profile_files import read_points
from vehicledyn.rail.profiles.profile_names import Kind, is_name
from vehicledyn.rail.profiles.profile_pieces import Floats, QuinticTable
from vehicledyn.rail.profiles.profile_reading import AS_IT_IS, ProfileReading
from vehicledyn.rail.profiles.profile_shape import NARROWEST, Measurement, in_our_axes
from vehicledyn.rail.profiles.smoothing import Smoothed, proposed_wavelength, slope_noise, smoothed

_NEARLY = 0.7
"""Part of the wavelength that would be proposed with which smoothing is left as it is [1]."""

_NOISE = 0.5e-6
"""Scatter of points above which a curve through them all is rough [m]."""


def open_profile(text: str, kind: Kind, reading: ProfileReading = AS_IT_IS) -> Profile:
    """Return the profile of a wheel or a rail, by name or from a file.

    Parameters
    ----------
    text
        Name such as "S1002", "60E1", "cone:1/40", or a file.
    kind
        What is needed, "wheel" or "rail".
    reading
        How the points of a file become a profile.

    Raises
    ------
    InputError
        If there is no such profile, or what the file holds is none.
    """
    if is_name(text) or not (Path(text).suffix or Path(text).exists()):
        return named_profile(text, kind)
    return read_profile(Path(text), kind, reading)


def read_profile(path: Path, kind: Kind, reading: ProfileReading = AS_IT_IS) -> Profile:
    """Return the profile in a file, turned into the axes of this program.

    Raises
    ------
    InputError
        If it cannot be read or is no profile; the text names file and line.
    """
    try:
        facts = path.stat()
    except (OSError, ValueError):
        return _read(path, kind, reading, 0, 0)  # which says what is wrong
    return _read(path, kind, reading, facts.st_mtime_ns, facts.st_size)


@lru_cache(maxsize=16)
def _read(path: Path, kind: Kind, reading: ProfileReading, changed: int, size: int) -> Profile:
    """Return the profile in a file that was changed at a time and has a size."""
    found = in_our_axes(read_points(path), kind, reading)
    curve = _curve(path, found, reading.smoothing)
    notes = [*found.notes, *_on_smoothing(curve, found.y, found.z, reading.smoothing)]
    shifted, down, said = _with_datum(curve.table, kind)
    measured = ProfileMeasurement(
        points=np.column_stack([found.y, found.z - down]),
        distance=curve.distance,
        outliers=found.outliers - (0.0, down),
        bridges=found.bridges,
        averaged=found.averaged - (0.0, down),
    )
    return Profile(path.stem, kind, (shifted,), str(path), (*notes, *said), measured)


def _curve(path: Path, found: Measurement, wavelength: float) -> Smoothed:
    """Return the curve through points, wide enough to carry a wheel or to roll."""
    try:
        curve = smoothed(found.y, found.z, wavelength)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    table = curve.table
    if table.end - table.begin < NARROWEST or not table.begin < 0.0 < table.end:
        raise InputError(
            f"{path}: the curve through the points is usable from y = {1e3 * table.begin:.4g} to "
            f"{1e3 * table.end:.4g} mm only, as it is steeper than 85 degrees there; mend the "
            f"defects of the points, or smooth them: {_proposal(found.y, found.z)[2]}"
        )
    return curve


def _on_smoothing(curve: Smoothed, y: Floats, z: Floats, wavelength: float) -> list[str]:
    """Return what smoothing did, or what it should do."""
    scatter, wanted, proposal = _proposal(y, z)
    if wavelength > 0.0:
        said = (
            f"smoothed over {1e3 * wavelength:g} mm: points lie up to {1e3 * curve.largest:.2g} mm "
            f"from the curve, {1e3 * curve.rms:.2g} mm in the root mean square"
        )
        if scatter < _NOISE or wavelength > _NEARLY * wanted:
            return [said]
        left = _mrad(scatter, _spacing(y, z), wavelength)
        return [said, f"slopes, and conicities with them, keep noise of {left}; {proposal}"]
    if scatter < _NOISE:
        return []
    return [
        f"points scatter by {1e6 * scatter:.2g} µm and are not smoothed: slopes and curvatures "
        f"hold the noise, and conicities are those of the noise; {proposal}"
    ]


def _proposal(y: Floats, z: Floats) -> tuple[float, float, str]:
    """Return the scatter of points, the wavelength to smooth them over [m], and what it leaves."""
    scatter, spacing = find_scatter(np.column_stack([y, z])), _spacing(y, z)
    wanted = proposed_wavelength(scatter, spacing)
    words = f'smoothing "{1e3 * wanted:.2g} mm" leaves {_mrad(scatter, spacing, wanted)}'
    return scatter, wanted, words


def _spacing(y: Floats, z: Floats) -> float:
    return float(np.median(np.hypot(np.diff(y), np.diff(z))))


def _mrad(scatter: float, spacing: float, wavelength: float) -> str:
    return f"{1e3 * slope_noise(scatter, spacing, wavelength):.2g} mrad"


def _with_datum(curve: QuinticTable, kind: Kind) -> tuple[QuinticTable, float, list[str]]:
    """Return the curve with z = 0 at the tape circle of a wheel, on the crown of a rail.

    With it comes by how much it was moved down [m], and what to say of that.
    """
    heights = curve.height(curve.places)
    zero = float(curve.height(np.array(0.0))) if kind == "wheel" else float(np.max(heights))
    raised = np.array([[zero], [0.0], [0.0]])
    where = "tape circle" if kind == "wheel" else "highest point"
    said = [f"z shifted by {-1e3 * zero:.4g} mm to zero at the {where}"] if abs(zero) > 1e-6 else []
    return replace(curve, left=curve.left - raised, right=curve.right - raised), zero, said
