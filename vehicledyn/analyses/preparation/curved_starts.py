"""Lead a vehicle from straight track to its balance in a curve, or say what helps.

Bodies start along the tangent of the frame that carries them, in tight curves axles far from it
beside the rails, and the search for the balance fails there. On straight track it does not; from
there the balance is followed along the track, while its curvature grows, to the place of the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown
from vehicledyn.rail.track.running import TRACK_POSITION
from vehicledyn.rail.track.track import Track
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.analyse.equilibrium import EquilibriumPoint
    from vehicledyn.kernel.derivatives import Slopes


Vector = NDArray[np.float64]

CLEAR = 6.0
"""Straight track beyond the axles at which a vehicle enters, see riding_line [m]."""

FARTHEST = 2000
"""How far behind the start straight track is looked for [m]."""

ON_THE_WAY = 1e-3
"""Largest acceleration that counts as balanced on the way [m/s², rad/s²]."""

_MOMENT = 1e-3


@dataclass(frozen=True)
class LeadIn:
    """Time at which all axles are on straight track, and how far behind the start [s, m]."""

    time: float
    distance: float

    @property
    def remark(self) -> str:
        """How an equilibrium was found from there."""
        return (
            "the equilibrium in the curve was found from that on straight track "
            f"{shown(self.distance, 'm')} behind it, followed along the track as curvature grows"
        )


class Search(Protocol):
    """Finds an equilibrium at a time near a point, or raises NumericalError."""

    def __call__(
        self, *, time: float, state: Vector, unknowns: Vector, settling: float | None
    ) -> EquilibriumPoint:
        """Return it."""


def led_into_curve(
    prepared: Prepared,
    entry: LeadIn,
    start: tuple[Vector, Vector],
    search: Search,
    *,
    pairs: tuple[list[int], list[int]],
    slopes: Slopes,
    settling: float,
) -> EquilibriumPoint:
    """Return the equilibrium in a curve, followed from straight track.

    Parameters
    ----------
    prepared
        The vehicle.
    entry
        Where the way begins.
    start
        States and unknowns of the start.
    search
        Finds the equilibria at both ends of the way: that in the curve fulfils what any other does.
    pairs
        States to move and rates that must vanish.
    slopes
        Derivatives of the equations.
    settling
        Step in which wheels are let down on their rails [m or rad].

    Raises
    ------
    NumericalError
        If there is no equilibrium on straight track or at a place on the way.
    """
    from vehicledyn.analyse.equilibrium_path import follow_equilibrium

    state, unknowns = start
    end = prepared.subject.balance_time
    begun = search(time=entry.time, state=state, unknowns=unknowns, settling=settling)
    near = follow_equilibrium(
        prepared.equations,
        prepared.kernel,
        begun,
        times=(entry.time, end),
        free=pairs[0],
        balanced=pairs[1],
        tolerance=ON_THE_WAY,
        derivatives=slopes,
        settling=settling,
    )
    return search(time=end, state=near.state, unknowns=near.unknowns, settling=None)


def straight_before(prepared: Prepared, state: Vector, unknowns: Vector) -> LeadIn | None:
    """Return where the vehicle was last on straight track; None where it is, or does not move."""
    end = prepared.subject.balance_time
    track, places = axle_places(prepared, state, unknowns, end)
    if track is None:
        return None
    now = np.array(list(places.values()))
    later = np.array(list(axle_places(prepared, state, unknowns, end + _MOMENT)[1].values()))
    speed = float(np.mean(later - now)) / _MOMENT
    distance = _to_straight(track, now)
    if not distance or abs(speed) * _MOMENT < 1e-9:
        return None
    time = end - distance / speed
    then = np.array(list(axle_places(prepared, state, unknowns, time)[1].values()))
    moved = float(np.abs(now - then - distance).max())
    return LeadIn(time, distance) if moved < 0.5 * CLEAR else None


def _to_straight(track: Track, places: Vector) -> float | None:
    """Return how far back all places lie on track that does not turn [m]; None if nowhere."""
    s = ops.symbol("s")
    turning = ops.numeric([s], track.line.frame(s).turning)
    back = np.arange(FARTHEST + 1.0)
    bent = [
        np.abs(np.asarray(turning((place - back + shift)[None, :]))).max(axis=0) > 0.0
        for place in places
        for shift in np.linspace(-CLEAR, CLEAR, 13)
    ]
    free = np.flatnonzero(~np.any(bent, axis=0))
    return float(back[free[0]]) if free.size else None


def axle_places(
    prepared: Prepared, state: Vector, unknowns: Vector, time: float | None = None
) -> tuple[Track | None, dict[str, float]]:
    """Return the track that curves, None if there is none, and the chainage of each axle [m].

    The time is that of the balance where none is given [s].
    """
    tracks = [track for part in prepared.subject.system.parts if (track := _track(part))]
    suffix = f".{TRACK_POSITION}"
    names = [channel.name for channel in prepared.equations.channels]
    chosen = [k for k, name in enumerate(names) if name.endswith(suffix)]
    if not tracks or not chosen or tracks[0].is_straight:
        return None, {}
    at = prepared.subject.balance_time if time is None else time
    outputs = prepared.kernel.outputs(at, state, unknowns)
    return tracks[0], {names[k].removesuffix(suffix): float(outputs[k]) for k in chosen}


def curve_advice(prepared: Prepared, state: Vector, unknowns: Vector) -> str:
    """Return a clause for the message that no balance is found, empty where no curve is."""
    track, places = axle_places(prepared, state, unknowns)
    if track is None:
        return ""
    s = ops.symbol("s")
    curvature = ops.numeric([s], track.line.curvature(s))
    sharpest = max(abs(float(np.squeeze(curvature(at)))) for at in places.values())
    if sharpest == 0.0:
        return ""
    return (
        f"; it starts along the tangent of a curve of {shown(1.0 / sharpest, 'm')}, beside the "
        "rails: give its bodies as 'initial' the places that they have at the end of a run which "
        "enters the curve from straight track"
    )


def _track(part: object) -> Track | None:
    """Return what the wheels of a part run on, None of one that has none."""
    found = getattr(getattr(part, "wheels", part), "track", None)
    return found if isinstance(found, Track) else None
