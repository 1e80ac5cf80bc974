"""The second cam of a conjugate pair, as a cam of its own."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np
from pydantic import PrivateAttr

from vehicledyn.cams.cam import Cam
from vehicledyn.cams.geometry import Array, CamGeometry, FollowerMotion, turned
from vehicledyn.cams.pieces import PieceCurve


class OppositeCam(Cam):
    """The second cam, in axes of its own: of a slide these are turned by half a turn."""

    _first: Cam = PrivateAttr()

    @cached_property
    def curve(self) -> PieceCurve | None:
        """Lift over a turn: where the first cam rises this one falls."""
        first = self._first.curve
        if first is None:
            return None
        return PieceCurve(tuple(p.changed(p.begin, p.width, -1.0, 0.0) for p in first.pieces))

    @cached_property
    def start(self) -> float:
        """Coordinate of the follower where the first has no lift [m or rad]."""
        pair = self._first.conjugate
        return (0.0 if pair is None else pair.apart) - self._first.start

    def moving(self, theta: Array) -> FollowerMotion:
        """Return the motion of the follower at angles of the cam [rad]."""
        first = self._first.moving(theta)
        total = self.start + self._first.start
        return FollowerMotion(first.theta, total - first.coordinate, -first.slope, -first.second)

    def in_axes_of_first(self, own: CamGeometry) -> CamGeometry:
        """Return a geometry with its pitch curve and profile in axes of the first cam."""
        pitch, profile = (turned(self._half_turn, points) for points in (own.pitch, own.profile))
        return replace(own, pitch=pitch, profile=profile)

    @property
    def _half_turn(self) -> Array:
        return np.array(0.0 if self.touch.rocks else math.pi)


def opposite_of(cam: Cam) -> OppositeCam | None:
    """Return the second cam of a pair, None of a single one."""
    if cam.conjugate is None:
        return None
    found = OppositeCam.model_construct(
        follower=cam.conjugate.follower, motion=cam.motion, base_radius=None, outline=None,
        conjugate=None,
    )  # fmt: skip
    found._first = cam
    return found
