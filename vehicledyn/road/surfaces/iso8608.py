"""Random roads by the classes of ISO 8608, with two tracks that know of each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field, model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.road.ground.random_road import RandomRoad
    from vehicledyn.symbolic.grids.grid_table import GridTable

CLASSES = {name: 16e-6 * 4.0**index for index, name in enumerate("ABCDEFGH")}
"""Gd(n0) of the classes, geometric means of their limits [m³]; ISO 8608:2016, table C.1."""

_MOST_LENGTH = 50_000.0


@register("road", "iso8608")
class Iso8608Road(RoadSurface):
    """Random ground with the spectrum Gd(n) = Gd(n0) (n / n0)^-w of a class of ISO 8608.

    Waves of all multiples of a lowest frequency with random phases add up, so that every record
    has the spectrum of its class. The heights of the two tracks are coherent as on ground that is
    the same in all directions, or as chosen; between and beside them the ground is straight
    across. The ground fades in and out smoothly and is level before and after.
    """

    in_equations: ClassVar[bool] = True

    road_class: Literal["A", "B", "C", "D", "E", "F", "G", "H"] | None = Field(
        default=None, description="Class, very good (A) to very poor; or give roughness"
    )
    roughness: float | None = quantity(
        "m^3", "Gd(n0) at 0.1 waves a metre, in place of a class", gt=0, default=None
    )
    waviness: float = quantity("1", "Exponent w of the spectrum", default=2.0, gt=1, le=4)
    length: float = quantity("m", "Length of the rough ground", gt=0, le=_MOST_LENGTH)
    start: float = quantity("m", "World x where it begins", default=0.0)
    fade: float = quantity("m", "Length over which it fades in and out", ge=0, default=5.0)
    track: float = quantity("m", "Distance of the two tracks across", gt=0, default=1.5)
    coherence: Literal["isotropic", "equal", "independent"] = Field(
        default="isotropic",
        description="Of the two tracks: as on isotropic ground, the same, or none",
    )
    seed: int = Field(default=1, ge=0, le=2**32 - 1, description="Which of all such roads")

    @model_validator(mode="after")
    def _check(self) -> Iso8608Road:
        """Refuse a road without a roughness, or with two, and fades that meet."""
        if (self.road_class is None) == (self.roughness is None):
            raise ValueError("give either road_class or roughness")
        if 2.0 * self.fade > self.length:
            raise ValueError("fade: longer than half the road")
        return self

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self._grid().value(x, y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        return self._grid().slopes(x, y)

    @property
    def record(self) -> RandomRoad:
        """What the road's heights are made from."""
        from vehicledyn.road.ground.random_road import RandomRoad

        roughness = self.roughness if self.road_class is None else CLASSES[self.road_class]
        assert roughness is not None
        return RandomRoad(
            roughness,
            self.waviness,
            self.length,
            self.start,
            self.fade,
            self.track,
            self.coherence,
            self.seed,
        )

    def _grid(self) -> GridTable:
        from vehicledyn.road.ground.random_road import ground

        return ground(self.record)
