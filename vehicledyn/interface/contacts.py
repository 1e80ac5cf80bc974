"""Contact geometry of wheel and rail from Python."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError
from vehicledyn.base.slope_text import slope_of
from vehicledyn.interface.quantities import positive, quantity
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.results.labelled.data import LabelledData


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
    shifts: Iterable[float | str] | None = None,
    amplitudes: Iterable[float | str] | None = None,
    save_to: str | Path | None = None,
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
    shifts, amplitudes
        Lateral shifts, and amplitudes of the conicity [m]; -8 to 8 mm and 1 to 7 mm if None.
    save_to, progress
        As for :func:`vehicledyn.simulate`.

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
    from vehicledyn.analyses.contact.contact_geometry import ContactWish, find_contact_geometry

    left = positive("radius", radius, "m")
    right = left if right_radius is None else positive("right_radius", right_radius, "m")
    wish = ContactWish(
        wheels=(str(wheel), str(right_wheel or wheel)),
        rails=(str(rail), str(right_rail or rail)),
        radii=(left, right),
        gauge=positive("gauge", gauge, "m"),
        gauge_depth=positive("gauge_depth", gauge_depth, "m"),
        inclination=_angle(inclination),
        back_to_back=positive("back_to_back", back_to_back, "m"),
        flange_back=quantity("flange_back", flange_back, "m"),
        yaw=quantity("yaw", yaw, "rad"),
        curvature=0.0
        if curve_radius is None
        else 1.0 / quantity("curve_radius", curve_radius, "m"),
        shifts=_lengths("shifts", shifts, range(-8, 9)),
        amplitudes=_lengths("amplitudes", amplitudes, range(1, 8)),
    )
    with result_place(save_to) as place:
        find_contact_geometry(wish, output=place.path, progress=reporter(progress))
        return place.value()


def _lengths(
    name: str, values: Iterable[float | str] | None, usual: Iterable[int]
) -> tuple[float, ...]:
    """Return lengths in SI, the usual ones in mm if none are given."""
    if values is None:
        return tuple(1e-3 * value for value in usual)
    return tuple(quantity(name, value, "m") for value in values)


def _angle(slope: float | str) -> float:
    found = slope_of(slope) if isinstance(slope, str) else float(slope)
    if found is None or not abs(found) < _STEEPEST:
        raise InputError(f"{given('inclination', slope)}: write a slope such as '1:40' or 0.025")
    return math.atan(found)


_STEEPEST = 0.5
