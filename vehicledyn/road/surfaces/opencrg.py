"""A road measured on a curved regular grid, from an OpenCRG file."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.road.opencrg.ground import CrgGround


@register("road", "opencrg")
class OpenCrgRoad(RoadSurface):
    """Road from an OpenCRG file (ASAM OpenCRG 1.2), text or binary.

    Heights between cross sections and long sections follow the file's grid; beyond it the last
    height goes on. A curved reference line is smoothed within the file's increment.
    """

    file: str = Field(description="OpenCRG file, beside the file that names it")
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

    def placed(self, folder: Path) -> OpenCrgRoad:
        """Return the same road, its file looked for in a folder."""
        return self.model_copy(update={"file": str(folder / self.file)})

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the file, one line each."""
        try:
            _ground(folder / self.file, self.origin, self.interpolation)
        except InputError as error:
            lines = str(error).splitlines()
            return lines[:-1] if len(lines) > 1 else lines
        return []

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return _ground(Path(self.file), self.origin, self.interpolation).height(x, y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        return _ground(Path(self.file), self.origin, self.interpolation).gradient(x, y)


def _ground(path: Path, origin: str, interpolation: str) -> CrgGround:
    """Return the ground of a file.

    Raises
    ------
    InputError
        If the file cannot be read or cannot be driven on; with line where there is one.
    """
    try:
        facts = path.stat()
    except OSError:
        raise InputError(f"{path}: there is no such file") from None
    return _read(path, origin, interpolation, facts.st_mtime_ns, facts.st_size)


@lru_cache(maxsize=8)
def _read(path: Path, origin: str, interpolation: str, changed: int, size: int) -> CrgGround:
    """Return the ground of a file that was changed at a time and has a size."""
    from vehicledyn.road.opencrg.ground import CrgGround, check_borders
    from vehicledyn.road.opencrg.modifiers import AT_REFERENCE_LINE
    from vehicledyn.road.opencrg.road import CrgRoad

    road = CrgRoad.read(path, move=None if origin == "file" else AT_REFERENCE_LINE)
    ground = CrgGround(road, interpolation == "smooth")
    try:
        check_borders(road)
        assert ground.grid is not None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return ground
