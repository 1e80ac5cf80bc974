"""Contact geometry of wheel and rail from Python."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.base.slope_text import slope_of
from vehicledyn.interface.quantities import positive, quantity
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.results.labelled.data import LabelledData

if TYPE_CHECKING:
    from vehicledyn.rail.profiles.profile_reading import ProfileReading


@checked
def contact_geometry(
    wheel: str | Path,
    rail: str | Path,
    *,
    gauge: float | str = "1435 mm",
    gauge_depth: float | str = "14 mm",
    inclination: float | str = "1:40",
    back_to_back: float | str = "1360 mm",
    flange_back: float | str = "70 mm",
    radius: float | str = "460 mm",
    right_wheel: str | Path | None = None,
    right_rail: str | Path | None = None,
    right_radius: float | str | None = None,
    yaw: float | str = 0.0,
    curve_radius: float | str | None = None,
    smoothing: float | str = 0.0,
    defects: Literal["refuse", "mend", "keep"] = "refuse",
    tape_circle: float | str | None = None,
    shifts: Iterable[float | str] | None = None,
    amplitudes: Iterable[float | str] | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
) -> LabelledData:
    """Return contact points, rolling radii, angles and equivalent conicity of a wheelset on rails.

    Parameters
    ----------
    wheel, rail
        Profiles by name, such as "S1002" and "60E1", "cone:1/40", "arc:RADIUS", or files.
    gauge, gauge_depth
        Gauge, and how far below the top of the rails it is measured [m].
    inclination
        Inclination of the rails as "1:40", or a number; "0" where the profile has it [1].
    back_to_back, flange_back
        Distance of the backs of the flanges, and of the tape circle from the back [m].
    radius, right_radius
        Radius of the tape circles, and that of the right wheel if it is another [m].
    right_wheel, right_rail
        Profiles of the right side, if they are others.
    yaw
        Yaw of the wheelset [rad].
    curve_radius
        Radius of the track, positive to the left; straight if None [m].
    smoothing
        Wavelength of which smoothing of profile files leaves half; 0 for none [m].
    defects
        What to do with outliers and gaps of files.
    tape_circle
        Distance of the tape circle from the back of the flange in files [m].
    shifts, amplitudes
        Lateral shifts, and amplitudes of the conicity [m]; -8 to 8 mm and 1 to 7 mm if None.
        Without amplitudes, ``[]``, there is no conicity.
    save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``radius_difference``, ``conicity``, ``contact.place``, ``contact.angle`` and more over
        ``shift``, ``amplitude`` and ``side``.

    Raises
    ------
    InputError
        If a profile or a number cannot be used.
    """
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.contact.contact_geometry import ContactRequest, find_contact_geometry
    from vehicledyn.results.tables.contact_table import write_contacts

    places = _lengths("shifts", shifts, range(-8, 9))
    if not places:
        raise InputError(f"{argument('shifts')}: give one value or more")
    left = positive("radius", radius, "m")
    right = left if right_radius is None else positive("right_radius", right_radius, "m")
    request = ContactRequest(
        wheels=(str(wheel), str(right_wheel or wheel)),
        rails=(str(rail), str(right_rail or rail)),
        radii=(left, right),
        gauge=positive("gauge", gauge, "m"),
        gauge_depth=positive("gauge_depth", gauge_depth, "m"),
        inclination=_angle(inclination),
        inclination_text=inclination.strip() if isinstance(inclination, str) else "",
        back_to_back=positive("back_to_back", back_to_back, "m"),
        flange_back=quantity("flange_back", flange_back, "m"),
        yaw=_yaw(yaw),
        curvature=0.0 if curve_radius is None else 1.0 / _curve_radius(curve_radius),
        reading=_reading(smoothing, defects, tape_circle),
        shifts=places,
        amplitudes=_lengths("amplitudes", amplitudes, range(1, 8)),
    )
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = find_contact_geometry(request, progress=reporter(progress), kept=place.kept)
        write_contacts(place.path, report.table)
        return place.value(report)


def _reading(
    smoothing: float | str, defects: str, tape_circle: float | str | None
) -> ProfileReading:
    """Return how profile files are read."""
    from vehicledyn.rail.profiles.profile_reading import ProfileReading

    wavelength = quantity("smoothing", smoothing, "m")
    if not 0.0 <= wavelength <= _LONGEST_WAVE:
        words = "must not be negative" if wavelength < 0.0 else "must be 100 mm or less"
        raise InputError(f"{given('smoothing', smoothing)}: {words}")
    back = None if tape_circle is None else quantity("tape_circle", tape_circle, "m")
    if back is not None and not _NEAREST_BACK < back < _FURTHEST_BACK:
        raise InputError(f"{given('tape_circle', tape_circle)}: must be between 20 and 150 mm")
    return ProfileReading.model_validate(
        {"smoothing": wavelength, "defects": defects, "tape_circle": back}
    )


def _lengths(
    name: str, values: Iterable[float | str] | None, usual: Iterable[int]
) -> tuple[float, ...]:
    """Return lengths in SI, the usual ones in mm if none are given."""
    if values is None:
        return tuple(1e-3 * value for value in usual)
    return tuple(quantity(name, value, "m") for value in values)


def _yaw(yaw: float | str) -> float:
    angle = quantity("yaw", yaw, "rad")
    if not abs(angle) < _LARGEST_YAW:
        raise InputError(f"{given('yaw', yaw)}: must be below {_LARGEST_YAW} rad")
    return angle


def _curve_radius(radius: float | str) -> float:
    found = quantity("curve_radius", radius, "m")
    if abs(found) < _TIGHTEST:
        raise InputError(f"{given('curve_radius', radius)}: must be {_TIGHTEST:g} m or more")
    return found


def _angle(slope: float | str) -> float:
    found = slope_of(slope) if isinstance(slope, str) else float(slope)
    if found is None or not abs(found) < _STEEPEST:
        raise InputError(f"{given('inclination', slope)}: write a slope such as '1:40' or 0.025")
    return math.atan(found)


_STEEPEST, _LARGEST_YAW, _TIGHTEST = 0.5, 0.2, 5.0
_LONGEST_WAVE, _NEAREST_BACK, _FURTHEST_BACK = 0.1, 0.02, 0.15
