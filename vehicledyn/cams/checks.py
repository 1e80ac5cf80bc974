"""What a cam cannot do: cusps, undercuts, jumps of velocity, contact beyond a face."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import field_unit
from vehicledyn.cams.cam import Cam
from vehicledyn.cams.follower import LineFollower
from vehicledyn.cams.followers.rocking import RockingFace
from vehicledyn.cams.followers.sliding import SlidingFace
from vehicledyn.cams.geometry import CamGeometry
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.opposite import OppositeCam, opposite_of

_SAMPLES = 3600
_JUMP = 1e-9
_LARGEST = 1e6
_GROWTH, _HALVINGS = 1.05, 200


class CamFault(NamedTuple):
    """What is wrong: the place in the cam that it concerns, and words with a remedy."""

    place: tuple[str | int, ...]
    words: str


def checked(cam: Cam, folder: Path) -> tuple[Cam, list[CamFault]]:
    """Return a cam with what its files hold, relative to a folder, and what is wrong with it."""
    found = list(_too_large(cam)) or list(_unread(cam, folder))
    if found:
        return cam, found
    whole = cam.beside(folder)
    found = list(_misfits(whole)) or list(_unlike(whole))
    return whole, found or list(faults(whole))


def _too_large(cam: Cam) -> Iterator[CamFault]:
    """Yield lengths that no cam has, whose squares are no numbers."""
    parts: list[tuple[tuple[str | int, ...], Any]] = [
        ((), cam),
        (("follower",), cam.follower),
        (("outline",), cam.outline),
        *((("motion", k), law) for k, law in enumerate(cam.laws)),
    ]
    if cam.conjugate is not None:
        parts += [
            (("conjugate",), cam.conjugate),
            (("conjugate", "follower"), cam.conjugate.follower),
        ]
    for place, item in parts:
        for name in type(item).model_fields if item is not None else ():
            value = getattr(item, name)
            numbers = value if isinstance(value, tuple) else (value,)
            is_length = field_unit(type(item), name) == "m"
            if is_length and any(abs(n) > _LARGEST for n in numbers if n is not None):
                words = f"is longer than {_LARGEST:g} m, which no cam is"
                yield CamFault((*place, name), words)


def _unread(cam: Cam, folder: Path) -> Iterator[CamFault]:
    """Yield laws and outlines that make no curve."""
    parts: list[tuple[tuple[str | int, ...], Any]] = [
        (("motion", k), law) for k, law in enumerate(cam.laws)
    ]
    if cam.outline is not None:
        parts.append((("outline",), cam.shape))
    for place, item in parts:
        try:
            read = item.beside(folder)
            if isinstance(read, MotionLaw):
                read.curve()
            else:
                read.support(np.zeros(1))
        except (ValueError, InputError) as error:
            yield CamFault(place, str(error))


def _misfits(cam: Cam) -> Iterator[CamFault]:
    """Yield a motion that does not close, and a follower that does not fit or reach."""
    for k, law in enumerate(cam.laws):
        if law.rise != 0.0 and law.turns != cam.touch.rocks:
            word, other = ("swing", "lift") if cam.touch.rocks else ("lift", "swing")
            words = f"has a {other}, but a follower of kind {cam.touch.kind} needs a {word}"
            yield CamFault(("motion", k), words)
            return
    steps: tuple[tuple[str, Callable[[], object]], ...] = (
        ("motion", lambda: cam.curve),
        ("follower", lambda: cam.start),
        (
            "follower",
            lambda: cam.touch.check_reach(cam.moving(cam.samples(720)).coordinate),
        ),
    )
    for field, step in steps:
        try:
            step()
        except ValueError as error:
            yield CamFault((field,), str(error))
            return


def _unlike(cam: Cam) -> Iterator[CamFault]:
    """Yield a second follower that cannot be on the slide or rocker of the first."""
    pair, second = cam.conjugate, opposite_of(cam)
    if pair is None or second is None:
        return
    place = ("conjugate", "follower")
    if "axial" in (cam.touch.shape, second.touch.shape):
        yield CamFault(place, "face and barrel cams have no second cam; a groove has two sides")
    elif second.touch.rocks != cam.touch.rocks:
        yield CamFault(place, f"must {'rock' if cam.touch.rocks else 'slide'} as the follower does")
    elif (pair.angle is not None) != cam.touch.rocks:
        given, asked = ("distance", "angle") if cam.touch.rocks else ("angle", "distance")
        yield CamFault(("conjugate", given), f"leave it out and give the {asked}")
    elif cam.touch.rocks and getattr(second.touch, "pivot", None) != getattr(
        cam.touch, "pivot", None
    ):
        yield CamFault(place, "pivot: must be that of the follower, which it is a part of")
    elif cam.touch.rocks and getattr(second.touch, "side", None) == getattr(
        cam.touch, "side", None
    ):
        yield CamFault(place, "side: must be the other one, so that the second cam pushes back")
    else:
        try:
            second.touch.check_reach(second.moving(second.samples(720)).coordinate)
        except ValueError:
            word = "angle" if cam.touch.rocks else "distance"
            words = f"the second follower does not reach its cam; take another {word}"
            yield CamFault(("conjugate",), words)


def faults(cam: Cam) -> Iterator[CamFault]:
    """Yield what makes a cam that cannot be cut or run, each with a remedy."""
    yield from _velocity_jumps(cam)
    theta = np.linspace(0.0, 2.0 * math.pi, _SAMPLES + 1)
    geometry = cam.geometry(theta)
    yield from _undercut(cam, geometry)
    yield from _face(cam, geometry)
    second = opposite_of(cam)
    if second is not None:
        geometry = second.geometry(theta)
        yield from _undercut(second, geometry)
        yield from _face(second, geometry)


def undercuts(cam: Cam, geometry: CamGeometry) -> NDArray[np.bool_]:
    """Return at which angles the profile has a cusp or is cut away, shape (n,)."""
    roller = cam.touch.roller
    if isinstance(cam.touch, LineFollower):
        turning = cam.touch.line(geometry.motion.coordinate).turning
        backward = turning * geometry.motion.slope - 1.0 >= 0.0
        return np.asarray((geometry.profile_radius <= 0.0) | backward)
    if roller == 0.0:
        return np.zeros(geometry.pitch_radius.shape, dtype=bool)
    radius = geometry.pitch_radius
    hollow = cam.outline is not None  # of an outline the roller may be too large for a hollow
    limit = roller * (1.0 + 1e-9)
    cut = (radius > 0.0) & (radius <= limit)
    if hollow:
        cut = geometry.profile_radius * np.sign(radius) < 0.0
    return np.asarray(cut)


def _undercut(cam: Cam, geometry: CamGeometry) -> Iterator[CamFault]:
    cut = undercuts(cam, geometry)
    if not cut.any():
        return
    theta = geometry.motion.theta
    first, last = (math.degrees(float(a)) for a in (theta[cut][0], theta[cut][-1]))
    where = f"between {first:.4g} and {last:.4g} deg of the cam"
    roller = cam.touch.roller
    field = _size_of(cam)
    if isinstance(cam.touch, LineFollower):
        worst = float(np.nanmin(geometry.profile_radius))
        words = (
            f"the flat face undercuts the cam {where}: the profile would need a radius of "
            f"curvature of {1e3 * worst:.4g} mm there, it must be above zero"
        )
    else:
        worst = float(geometry.pitch_radius[cut].min())
        words = (
            f"the roller undercuts the cam {where}: the path of its centre has a radius of "
            f"curvature of {1e3 * worst:.4g} mm there, less than the roller's {1e3 * roller:.4g} mm"
        )
    yield CamFault((field,), f"{words}; {_remedy(cam)}")


def _size_of(cam: Cam) -> str:
    """Return the field that gives a cam its size."""
    if isinstance(cam, OppositeCam):
        return "conjugate"
    return "outline" if cam.base_radius is None else "base_radius"


def _remedy(cam: Cam) -> str:
    """Return what to change so that nothing is cut away."""
    if isinstance(cam, OppositeCam):
        apart = "angle" if cam.touch.rocks else "distance"
        return f"take a larger {apart}, a smaller roller, or more angle for the law"
    if cam.base_radius is None:
        return "take a smaller roller or larger arcs"
    enough = enough_base(cam)
    size = (
        "take a larger base radius"
        if enough is None
        else (f"take a base radius of {1e3 * enough:.4g} mm or more")
    )
    roller = "" if isinstance(cam.touch, LineFollower) else "a smaller roller, "
    return f"{size}, {roller}or more angle for the law"


def enough_base(cam: Cam) -> float | None:
    """Return the least base radius without undercut, rounded up; None if none is found [m]."""

    def is_cut(base: float) -> bool:
        wider = Cam.model_construct(**{**dict(cam), "base_radius": base})
        theta = np.linspace(0.0, 2.0 * math.pi, 721)
        try:
            wider.touch.check_reach(wider.moving(theta).coordinate)
            return bool(undercuts(wider, wider.geometry(theta)).any())
        except ValueError:
            return True

    low = high = float(cam.base_radius or 0.0)
    for _ in range(_HALVINGS):
        if not is_cut(high):
            break
        low, high = high, high * _GROWTH
    else:
        return None
    while high - low > 1e-3 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_cut(middle) else (low, middle)
    return high


def _velocity_jumps(cam: Cam) -> Iterator[CamFault]:
    if cam.curve is None:
        return
    theta = np.array(cam.curve.knots)
    most = float(np.abs(cam.curve.derivatives(np.linspace(0.0, 2.0 * math.pi, 721))[1]).max())
    jumps = [
        at % (2.0 * math.pi)
        for at, jump in cam.curve.jumps(1)
        if abs(jump) > _JUMP * max(most, _JUMP)
    ]
    if jumps and theta.size:
        listed = ", ".join(f"{math.degrees(at):.4g} deg" for at in jumps)
        yield CamFault(
            ("motion",),
            f"the velocity jumps at {listed}: the profile has a corner, which no follower passes; "
            "take laws that begin and end at rest, or a polynomial whose derivatives fit",
        )


def _face(cam: Cam, geometry: CamGeometry) -> Iterator[CamFault]:
    """Yield contacts beyond the ends of a face."""
    if geometry.along is None:
        return
    low, high = float(geometry.along.min()), float(geometry.along.max())
    touch = cam.touch
    if isinstance(touch, SlidingFace) and touch.face is not None:
        ends = (-abs(touch.face[0]), abs(touch.face[1]))
    elif isinstance(touch, RockingFace):
        ends = (0.0, math.inf if touch.length is None else touch.length)
    else:
        return
    if low < ends[0] or high > ends[1]:
        yield CamFault(
            ("conjugate",) if isinstance(cam, OppositeCam) else ("follower",),
            f"the contact moves from {1e3 * low:.4g} to {1e3 * high:.4g} mm along the face, which "
            f"goes from {1e3 * ends[0]:.4g} to {1e3 * ends[1]:.4g} mm; make the face as long",
        )
