"""Ground measured on a square grid."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.file_surface import FileSurface
from vehicledyn.road.surfaces.surface import Lines, SteepPlace, lines_of_grid
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.road.surfaces.surface import Array
    from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid


@register("road", "heightfield")
class Heightfield(FileSurface):
    """Ground through heights on a square grid, from an ESRI ASCII grid in metres.

    Between the nodes by bicubic convolution, with continuous slope; beyond the grid the height
    of its edge goes on. The file's own x and y are those of the world, x forward, y to the left.
    """

    has_end: ClassVar[bool] = True

    x: float = quantity("m", "World x of the file's x = 0", default=0.0)
    y: float = quantity("m", "World y of the file's y = 0", default=0.0)
    rise: float = quantity("m", "Height added to those of the file", default=0.0)
    scale: float = quantity("1", "Factor on the heights of the file", default=1.0)

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self.rise + self.scale * self.ground().value(x - self.x, y - self.y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        along, across = self.ground().slopes(x - self.x, y - self.y)
        return self.scale * along, self.scale * across

    def covers(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether places lie on the grid."""
        found: NDArray[np.bool_] = self.ground().covers(x - self.x, y - self.y)
        return found

    def lines(self) -> Lines:
        """Return the extent of the grid and its lines along x."""
        return lines_of_grid(self.ground(), self.x, self.y)

    def steepest(self) -> SteepPlace:
        """Return the steepest place between neighbouring nodes."""
        slope, x, y = self.ground().steepest()
        return SteepPlace(abs(self.scale) * slope, x + self.x, y + self.y)

    @classmethod
    def read(cls, path: Path, *settings: object) -> BicubicGrid:
        """Return the surface through the heights; see :meth:`FileSurface.read`."""
        from vehicledyn.road.ground.ascii_grid import read_ascii_grid
        from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid

        return BicubicGrid("heightfield", *read_ascii_grid(path))
