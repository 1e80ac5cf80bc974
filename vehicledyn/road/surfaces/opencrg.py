"""A road measured on a curved regular grid, from an OpenCRG file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.file_surface import FileSurface
from vehicledyn.road.surfaces.surface import Lines, Slopes
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.road.opencrg.ground import CrgGround
    from vehicledyn.road.surfaces.surface import Array

_FILLED = (
    "each is filled with the height of its neighbour towards the middle, or as grid_nan_mode in "
    "$ROAD_CRG_MODS says; the summary names the first wheel that rolls there"
)


@register("road", "opencrg")
class OpenCrgRoad(FileSurface):
    """Road from an OpenCRG file (ASAM OpenCRG 1.2), text or binary.

    Heights between cross sections and long sections follow the file's grid; beyond it the last
    height goes on. A curved reference line is smoothed within the file's increment.
    """

    has_end: ClassVar[bool] = True

    origin: Literal["reference_line", "file"] = Field(
        default="reference_line",
        description="Where the world begins: at the start of the reference line, which then runs "
        "along x at height zero; or where the file and its modifiers put it",
    )
    interpolation: Literal["smooth", "linear"] = Field(
        default="smooth",
        description="Along the road: with continuous slope, or straight from height to height "
        "as the standard evaluates it",
    )

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self.ground().height(x, y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        along, across = self.ground().gradient(x, y)
        return along, across

    def lines(self) -> Lines:
        """Return the extent of the reference line and the long sections."""
        road = self.ground().road
        across = tuple(map(float, road.v))
        straight = self.interpolation == "linear"
        return Lines(road.line.start, road.line.stop, across, straight)

    def on_line(self, u: Scalar, v: Scalar) -> Scalar:
        """Return the height at a place of the reference line [m]."""
        return self.ground().on_line(u, v)

    def line_place(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar, Slopes, Slopes]:
        """Return the place along and across the reference line [m], with their gradients."""
        u, v, by_u, by_v = self.ground().place(x, y)
        return u, v, by_u, by_v

    def covers(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether places lie on the grid, or where its borders repeat it."""
        found: NDArray[np.bool_] = self.ground().road.covers(x, y)
        return found

    def lacks(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether heights at places are filled for ones that the file does not have."""
        found: NDArray[np.bool_] = self.ground().road.lacks(x, y)
        return found

    def gaps(self) -> str:
        """Return how many heights the file lacks, where the first is, and that it is filled."""
        words: str = self.ground().road.gaps()
        return words and f"{self.file}: {words}; {_FILLED}"

    def settings(self) -> tuple[str, str]:
        """Return where the world begins, and the interpolation."""
        return self.origin, self.interpolation

    @classmethod
    def read(cls, path: Path, *settings: str) -> CrgGround:
        """Return the ground in a file; see :meth:`FileSurface.read`."""
        from vehicledyn.road.opencrg.ground import CrgGround, check_borders
        from vehicledyn.road.opencrg.modifiers import AT_REFERENCE_LINE
        from vehicledyn.road.opencrg.road import CrgRoad

        origin, interpolation = settings
        road = CrgRoad.read(path, move=None if origin == "file" else AT_REFERENCE_LINE)
        ground = CrgGround(road, interpolation == "smooth")
        try:
            check_borders(road)
            assert ground.grid is not None
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
        return ground
