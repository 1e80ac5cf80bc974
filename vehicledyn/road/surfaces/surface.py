"""What a road surface is: a height z(x, y) with its gradient and friction, in world axes."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias

from vehicledyn.base.parameters import ParameterSet, part
from vehicledyn.road.patches.patch import FrictionPatch, friction_at
from vehicledyn.road.soils.soil import Soil
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid

    Array = NDArray[np.float64]

Slopes: TypeAlias = tuple[Scalar, Scalar]


class SteepPlace(NamedTuple):
    """A slope, without sign [1], and the place that has it in world axes [m]."""

    slope: float
    x: float
    y: float


class Lines(NamedTuple):
    """Where a surface has data: first and last place along it and its lines across [m].

    ``straight`` says that it is straight across from line to line.
    """

    first: float
    last: float
    across: tuple[float, ...]
    straight: bool = False


class RoadSurface(ParameterSet):
    """Ground z = height(x, y); every surface of the catalogue derives from it.

    ``is_flat`` says that the ground is one plane, so that the contact point of a wheel has
    a closed form; otherwise it is found by Newton's method together with the loops. ``has_end``
    says that it comes from data of a part of the ground, see :meth:`covers`. ``felt_by_patch`` says
    that height and slope are those that a whole contact patch feels, not those of the ground.
    """

    is_flat: ClassVar[bool] = False
    has_end: ClassVar[bool] = False
    felt_by_patch: ClassVar[bool] = False

    patches: list[FrictionPatch] = part(
        "patch", "Patches of other friction; where they overlap the last one counts", default=[]
    )

    def placed(self, folder: Path) -> RoadSurface:
        """Return the same surface, with files that it names looked for in a folder."""
        return self

    soil: Soil | None = part(
        "soil", "Soil that the wheels sink into; without it the ground is rigid", default=None
    )

    @abstractmethod
    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height z of the ground [m] at a place [m, m] of the world."""

    @abstractmethod
    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes ∂z/∂x and ∂z/∂y [1] at a place [m, m] of the world."""

    def steepest(self) -> SteepPlace | None:
        """Return the steepest place of ground that comes from a file; None for other ground."""
        return None

    def lines(self) -> Lines | None:
        """Return where the surface has data along and across; None for surfaces by formulas."""
        return None

    def on_line(self, u: Scalar, v: Scalar) -> Scalar:
        """Return the height at a place along and across [m]: of the world, or of its own line."""
        return self.height(u, v)

    def line_place(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar, Slopes, Slopes]:
        """Return the place along and across of a place of the world [m], with their gradients."""
        return x, y, (1.0, 0.0), (0.0, 1.0)

    def covers(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether there are data at places [m, m] of the world, shape (n,)."""
        import numpy as np

        return np.ones(np.shape(x), dtype=bool)

    def lacks(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether heights at places [m, m] are made up for missing ones, shape (n,)."""
        import numpy as np

        return np.zeros(np.shape(x), dtype=bool)

    def gaps(self) -> str:
        """Return how many heights of the file are missing and what fills them; empty for none."""
        return ""

    def friction(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the friction at a place over that of the tyres' own road [1]."""
        return friction_at(self.patches, x, y)


def ground_normal(surface: RoadSurface, x: Scalar, y: Scalar) -> Vec:
    """Return the upward unit normal of the ground in world axes, n ∝ (-∂z/∂x, -∂z/∂y, 1)."""
    slope_x, slope_y = surface.gradient(x, y)
    return ops.unit(ops.vector(-slope_x, -slope_y, 1.0))


def lines_of_grid(grid: BicubicGrid, x: float, y: float) -> Lines:
    """Return the lines of a square grid that is moved by x and y [m]."""
    along, across = grid.values.shape
    first = x + grid.x
    places = tuple(y + grid.y + grid.step * k for k in range(across))
    return Lines(first, first + grid.step * (along - 1), places)
