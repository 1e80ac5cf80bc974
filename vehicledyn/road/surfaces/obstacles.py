"""Steps, cleats, kerbs and potholes across the road, as a tyre that envelops them feels them."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from pydantic import Field, model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.symbolic.tables import CurveTable


@register("road", "obstacles")
class Obstacles(RoadSurface):
    """Level ground with obstacles across it, smoothed by the cams of a tyre's envelope.

    Take ``contact: tangent_plane`` or ``vertical``: height and slope are those that the whole
    contact patch feels at the wheel's centre, so that no point of contact is looked for.
    With two cams the slope is that between them, not that of the height.
    """

    in_equations: ClassVar[bool] = True
    felt_by_patch: ClassVar[bool] = True

    crest: float = quantity("m", "Height of an obstacle; negative for a pothole")
    start: float = quantity("m", "World x where the first obstacle begins")
    length: float | None = quantity(
        "m", "Length with its bevels; without it a step that stays", gt=0, default=None
    )
    bevel: float = quantity("m", "Length of the slope at either edge", ge=0, default=0.0)
    count: int = Field(default=1, ge=1, le=1000, description="Number of obstacles, one a spacing")
    spacing: float | None = quantity(
        "m", "Distance from the start of one obstacle to that of the next", gt=0, default=None
    )
    cam_length: float = quantity("m", "Half axis of a cam along the road", gt=0)
    cam_height: float = quantity("m", "Half axis of a cam upwards", gt=0)
    cam_order: float = quantity("1", "Exponent of a cam's outline", default=1.8, gt=1, le=20)
    cam_spacing: float = quantity(
        "m", "Distance of the two cams, about 0.8 times the contact length", ge=0, default=0.0
    )

    @model_validator(mode="after")
    def _check(self) -> Obstacles:
        """Refuse obstacles that overlap or have no room for their bevels."""
        if self.length is not None and self.length < 2.0 * self.bevel:
            raise ValueError("length: too short for two bevels")
        if self.count > 1 and (self.length is None or self.spacing is None):
            raise ValueError("count: several obstacles need a length and a spacing")
        if self.spacing is not None and self.length is not None and self.spacing < self.length:
            raise ValueError("spacing: the obstacles overlap")
        return self

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the effective height of the ground [m]."""
        return self._felt()[0].value(x)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the effective slope along x [1]; the slope along y is zero."""
        height, slope = self._felt()
        return height.slope(x) if slope is None else slope.value(x), 0.0

    def outline(self) -> tuple[list[float], list[float]]:
        """Return the corners x and z of the ground before enveloping [m]."""
        x, z = [self.start], [0.0]
        for index in range(self.count):
            begin = self.start + index * (self.spacing or 0.0)
            x += [begin, begin + self.bevel]
            z += [0.0, self.crest]
            if self.length is not None:
                x += [begin + self.length - self.bevel, begin + self.length]
                z += [self.crest, 0.0]
        return x, z

    def _felt(self) -> tuple[CurveTable, CurveTable | None]:
        """Return the tables of effective height and slope; no slope where it is the height's."""
        from vehicledyn.road.ground.enveloping import EnvelopingCam, Tandem, enveloped_profile

        x, z = self.outline()
        cam = EnvelopingCam(self.cam_length, self.cam_height, self.cam_order)
        return enveloped_profile(Tandem(cam, self.cam_spacing), tuple(x), tuple(z))
