"""Any other road, as a tyre that envelops short unevenness feels it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import model_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import part, quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.road.ground.enveloped_ground import EnvelopedGround
    from vehicledyn.road.ground.enveloping import Tandem
    from vehicledyn.road.surfaces.surface import Array

_FIELDS = ("first", "last", "right", "left")
_HAVE_CAMS = ("obstacles", "enveloped")


@register("road", "enveloped")
class Enveloped(RoadSurface):
    """Another road, smoothed by the cams of a tyre's envelope that roll along it.

    The cams roll along x, on an OpenCRG road along its reference line. Their lift is found once,
    on lines along the road and every ``step`` from the begin of its data, or from zero, and is
    straight across from line to line. Take
    ``contact: tangent_plane`` or ``vertical``: height and slope are those that the whole contact
    patch feels at the wheel's centre. With two cams the slope is that between them. Where two
    touches of a cam meet, the height is off by a quarter of a step times the change of slope at
    most; beside a corner of the road that is at no step, by half a step times the slope there.
    """

    in_equations: ClassVar[bool] = True
    felt_by_patch: ClassVar[bool] = True
    has_end: ClassVar[bool] = True

    road: RoadSurface = part("road", "The road under the cams")
    cam_length: float = quantity("m", "Half axis of a cam along the road", gt=0)
    cam_height: float = quantity("m", "Half axis of a cam upwards", gt=0)
    cam_order: float = quantity("1", "Exponent of a cam's outline", default=1.8, gt=1, le=20)
    cam_spacing: float = quantity(
        "m", "Distance of the two cams, about 0.8 times the contact length", ge=0, default=0.0
    )
    step: float = quantity("m", "Distance of the samples along the road", gt=0, default=0.005)
    spread: float = quantity(
        "m",
        "Largest distance of the lines across; a road that is straight between lines of its "
        "own keeps these",
        gt=0,
        default=0.1,
    )
    first: float | None = quantity(
        "m", "Where along the road it begins; its beginning if left out", default=None
    )
    last: float | None = quantity(
        "m", "Where along the road it ends; its end if left out", default=None
    )
    right: float | None = quantity(
        "m", "Place across of the first line; the right edge if left out", default=None
    )
    left: float | None = quantity(
        "m", "Place across of the last line; the left edge if left out", default=None
    )

    @model_validator(mode="after")
    def _check(self) -> Enveloped:
        """Refuse roads with cams of their own, and places in the wrong order."""
        if self.road.kind in _HAVE_CAMS:
            raise ValueError(f"road: the road '{self.road.kind}' has cams of its own")
        if self.road.patches or self.road.soil is not None:
            raise ValueError("road: give patches and soil to the enveloped road itself")
        for low, high in (("first", "last"), ("right", "left")):
            a, b = getattr(self, low), getattr(self, high)
            if a is not None and b is not None and b <= a:
                raise ValueError(f"{high}: {b:g} m does not lie beyond {low}, {a:g} m")
        return self

    def placed(self, folder: Path) -> Enveloped:
        """Return the same road, its files looked for in a folder."""
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self).model_construct(**fields | {"road": self.road.placed(folder)})

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the road below, one line each."""
        look = getattr(self.road, "problems_beside", None)
        found: list[str] = look(folder) if callable(look) else []
        if found:
            return found
        from vehicledyn.road.ground.enveloped_ground import samples

        placed = self.placed(folder)
        try:
            first, last, across = placed._ends()
            samples(self._tandem, (first, last), len(across), self.step)
        except InputError as error:
            return [str(error)]
        return []

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the effective height of the ground [m]."""
        u, v, _, _ = self.road.line_place(x, y)
        return self._felt.height(u, v)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the effective slopes along x and y [1]."""
        u, v, by_u, by_v = self.road.line_place(x, y)
        along, across = self._felt.slopes(u, v)
        return along * by_u[0] + across * by_v[0], along * by_u[1] + across * by_v[1]

    def covers(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether the road below has data at places."""
        return self.road.covers(x, y)

    def lacks(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether heights of the road below are made up for missing ones."""
        return self.road.lacks(x, y)

    def gaps(self) -> str:
        """Return how many heights the road below lacks; empty for none."""
        return self.road.gaps()

    def _ends(self) -> tuple[float, float, Any]:
        """Return where the cams roll: first and last place along, and the lines across."""
        import numpy as np

        data, given = self.road.lines(), [getattr(self, name) for name in _FIELDS]
        if data is None:
            missing = [name for name, value in zip(_FIELDS, given, strict=True) if value is None]
            if missing:
                raise InputError(
                    f"road: the road '{self.road.kind}' has no ends of its own; give "
                    f"{', '.join(missing)} of the part that the cams roll on"
                )
            ends = (self.first, self.last, self.right, self.left)
            return ends[0], ends[1], _refined(np.array(ends[2:]), self.spread)  # type: ignore[return-value]
        ends = (data.first, data.last, data.across[0], data.across[-1])
        first, last, right, left = (
            own if value is None else value for own, value in zip(ends, given, strict=True)
        )
        across = np.array(data.across)
        kept = across[np.maximum(np.searchsorted(across, right, "right") - 1, 0) :]
        kept = kept[: np.searchsorted(kept, left) + 1]
        beside = last <= data.first or first >= data.last
        if beside or last <= first or len(kept) < len(("right", "left")):
            raise InputError(
                f"first, last, right, left: the part of the road is empty: its data lie from "
                f"{data.first:g} to {data.last:g} m along and from {across[0]:g} to "
                f"{across[-1]:g} m across"
            )
        return first, last, kept if data.straight else _refined(kept, self.spread)

    @property
    def _tandem(self) -> Tandem:
        from vehicledyn.road.ground.enveloping import EnvelopingCam, Tandem

        return Tandem(
            EnvelopingCam(self.cam_length, self.cam_height, self.cam_order), self.cam_spacing
        )

    @cached_property
    def _felt(self) -> EnvelopedGround:
        from vehicledyn.road.ground.enveloped_ground import enveloped_ground

        first, last, across = self._ends()
        data = self.road.lines()
        anchor = 0.0 if data is None else data.first
        along, height = (first, last), self.road.on_line
        return enveloped_ground(height, self._tandem, along, across, self.step, anchor=anchor)


def _refined(places: Array, spread: float) -> Array:
    """Return places with further ones in between, so that none lie farther apart."""
    import numpy as np

    cells = np.maximum(np.ceil(np.diff(places) / spread - 1e-9), 1.0).astype(int)
    pieces = [
        np.linspace(a, b, count, endpoint=False)
        for a, b, count in zip(places[:-1], places[1:], cells, strict=True)
    ]
    return np.concatenate([*pieces, places[-1:]])
