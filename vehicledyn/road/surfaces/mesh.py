"""Ground from a mesh of triangles."""

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


@register("road", "mesh")
class Mesh(FileSurface):
    """Ground from a Wavefront OBJ file with z upwards, its highest triangles seen from above.

    The mesh is sampled on a square grid; between the nodes the ground is smooth, by bicubic
    convolution, so edges of the mesh are rounded over one or two cells. Beyond the mesh the
    height of its edge goes on.
    """

    in_equations: ClassVar[bool] = True
    has_end: ClassVar[bool] = True

    cell: float = quantity("m", "Distance of the nodes of the grid", default=0.05, gt=0)
    x: float = quantity("m", "World x of the file's x = 0", default=0.0)
    y: float = quantity("m", "World y of the file's y = 0", default=0.0)
    rise: float = quantity("m", "Height added to those of the file", default=0.0)

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self.rise + self.ground().value(x - self.x, y - self.y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        along, across = self.ground().slopes(x - self.x, y - self.y)
        return along, across

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
        return SteepPlace(slope, x + self.x, y + self.y)

    def settings(self) -> tuple[float]:
        """Return the distance of the nodes [m]."""
        return (self.cell,)

    @classmethod
    def read(cls, path: Path, *settings: float) -> BicubicGrid:
        """Return the surface through the nodes; see :meth:`FileSurface.read`."""
        from vehicledyn.road.ground.mesh_grid import grid_of_mesh
        from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid

        return BicubicGrid("mesh", *grid_of_mesh(path, *settings))
