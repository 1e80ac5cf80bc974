"""Derivatives of contact geometry of a wheel profile on a rail by the measures of both."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.contact.contact_geometry import ContactRequest, placed
from vehicledyn.analyses.contact.contact_slopes import PARAMETERS, SEEN, ContactSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.analyses.sensitivity.names import matching
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.slope_text import slope_of
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown, to_si
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_FORM = "profiles(QUANTITY, -3 mm:3 mm:6, rail=60E1, gauge=1435 mm)"
_CONICITY = "conicity"
_LENGTHS = "gauge", "gauge_depth", "back_to_back", "flange_back"
_OTHERS = "rail", "inclination", "radius", "right_radius", "yaw", "curve_radius"
_INCLINATION, _STEEPEST, _LARGEST_YAW, _TIGHTEST = "1:40", 0.5, 0.2, 5.0


@dataclass(frozen=True)
class _Asked:
    """A quantity at shifts, or the conicity of amplitudes [m], of a wheelset on a track.

    ``settings`` are the ones given besides the rail, as text.
    """

    quantity: str
    values: tuple[float, ...]
    rail: str
    settings: str
    request: ContactRequest


def find_contact_sensitivity(
    file: str, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of contact geometry by shift, gauge and other measures.

    Parameters
    ----------
    file
        Wheel profile by name, such as "S1002", or a file.
    of
        Names such as ``profiles(radius_difference, 2 mm, rail=60E1)`` and
        ``profiles(conicity, 3 mm, rail=60E1, inclination=1:20)``, the latter of an amplitude.
    to
        Patterns of measures, such as ``gauge``.
    progress
        Called with what is going on.
    memory
        Not used: it takes little time.

    Raises
    ------
    InputError
        If a profile or name cannot be used, or the wheelset does not stand there.
    """
    asked = [_parsed(name, file) for name in of]
    chosen = matching(list(PARAMETERS), to, "the contact geometry")
    figures, values, slopes, places, notes = [], [], [], [], []
    known: dict[ContactRequest, ContactSlopes] = {}
    for item in asked:
        own = item.request
        if own not in known:
            progress("reading profiles", None)
            known[own] = ContactSlopes(placed(own)[0], own.gauge_depth, own.yaw)
        for at in item.values:
            quantity = _quantity(item, at)
            progress(f"differentiating {quantity.name}", None)
            value, slope, trouble = _found(item, known[own], at)
            figures.append(quantity)
            values.append(value)
            places.append(_values(item, at)[chosen])
            slopes.append(np.full(len(slope), np.nan) if trouble else slope)
            if trouble:
                notes.append(f"warning: '{quantity.name}' has no derivative: {trouble}")
    names, every = list(PARAMETERS), np.array(places)
    same = np.all(every == every[0], axis=0)
    return SensitivityTable(
        f"{file} on {', '.join(dict.fromkeys(item.rail for item in asked))}",
        file,
        tuple(Quantity(names[k], *PARAMETERS[names[k]]) for k in chosen),
        np.where(same, every[0], np.nan),
        tuple(figures),
        np.array(values),
        np.array(slopes)[:, chosen],
        notes=tuple(notes),
        places=None if same.all() else every,
    )


def _found(asked: _Asked, slopes: ContactSlopes, at: float) -> tuple[float, Floats, str]:
    if asked.quantity == _CONICITY:
        wheels = slopes.wheelset.left_wheel, slopes.wheelset.right_wheel
        base = wheels[0].half_distance + wheels[1].half_distance
        return slopes.conicity(at, 0.5 * (wheels[0].radius + wheels[1].radius), base)
    values, rows, trouble = slopes.at(at)
    k = list(SEEN).index(asked.quantity)
    return float(values[k]), rows[k], trouble


def _quantity(asked: _Asked, at: float) -> Quantity:
    where = f"{shown(at, 'm')} on {asked.rail}{asked.settings}"
    if asked.quantity == _CONICITY:
        name = f"conicity at amplitude = {where}"
        return Quantity(name, "1", "Equivalent conicity by integration")
    name = f"{asked.quantity} at shift = {where}"
    return Quantity(name, *SEEN[asked.quantity])


def _values(asked: _Asked, at: float) -> Floats:
    """Return the measures that derivatives are by, as in ``PARAMETERS``."""
    r = asked.request
    own = {
        "shift": 0.0 if asked.quantity == _CONICITY else at,
        "left_radius": r.radii[0],
        "right_radius": r.radii[1],
    }
    return np.array([own[n] if n in own else float(getattr(r, n)) for n in PARAMETERS])


def _parsed(name: str, wheel: str) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    parts, options = called_parts(name, _FORM, (2,), (*_OTHERS, *_LENGTHS))
    known = [*SEEN, _CONICITY]
    if parts[0] not in known:
        raise InputError(f"'{name}': {unknown_name('quantity', parts[0], known)}")
    if "rail" not in options:
        raise InputError(f"'{name}': name the rail, such as rail=60E1")
    try:
        values = read_range(parts[1]).values("m")
        request = _request(wheel, options)
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    if parts[0] == _CONICITY and not 0.0 < min(values) <= max(values) <= 0.1:
        raise InputError(f"'{name}': amplitudes lie above 0 and up to 100 mm")
    rail = options.pop("rail")
    settings = "".join(f", {key} = {value}" for key, value in options.items())
    return _Asked(parts[0], values, rail, settings, request)


def _request(wheel: str, options: Mapping[str, str]) -> ContactRequest:
    """Return which wheels stand on which track."""
    lengths: dict[str, Any] = {k: to_si(options[k], "m") for k in _LENGTHS if k in options}
    radius = to_si(options.get("radius", "460 mm"), "m")
    radii = radius, to_si(options.get("right_radius", radius), "m")
    wrong = [key for key, value in lengths.items() if key != "flange_back" and not value > 0.0]
    if wrong or not min(radii) > 0.0:
        raise InputError(f"{wrong[0] if wrong else 'radius'}: must be above zero")
    slope = slope_of(options.get("inclination", _INCLINATION))
    if slope is None or not abs(slope) < _STEEPEST:
        raise InputError("inclination: write a slope such as 1:40 or 0.025")
    yaw = to_si(options.get("yaw", 0.0), "rad")
    if not abs(yaw) < _LARGEST_YAW:
        raise InputError(f"yaw: must be below {_LARGEST_YAW} rad")
    bend = to_si(options["curve_radius"], "m") if "curve_radius" in options else math.inf
    if not abs(bend) >= _TIGHTEST:
        raise InputError(f"curve_radius: must be {_TIGHTEST:g} m or more")
    return ContactRequest(
        (wheel, wheel),
        (options["rail"], options["rail"]),
        radii,
        inclination=math.atan(slope),
        yaw=yaw,
        curvature=1.0 / bend,
        **lengths,
    )
