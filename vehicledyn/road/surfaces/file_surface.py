"""Ground from a file: where the file is, what is wrong with it, and reading it once."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

from pydantic import Field

from vehicledyn.base.errors import InputError
from vehicledyn.road.surfaces.surface import RoadSurface


class FileSurface(RoadSurface):
    """Surface from a file beside the file that names it."""

    file: str = Field(description="File of the ground, in the folder of the file that names it")

    def placed(self, folder: Path) -> Self:
        """Return the same ground, its file looked for in a folder."""
        return self.model_copy(update={"file": str(folder / self.file)})

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the file, one line each."""
        try:
            self.placed(folder).ground()
        except InputError as error:
            lines = str(error).splitlines()
            return lines[:-1] if len(lines) > 1 else lines
        return []

    def ground(self) -> Any:
        """Return what :meth:`read` makes of the file, read again when it has changed.

        Raises
        ------
        InputError
            If the file cannot be read or holds no ground; with line where there is one.
        """
        path = Path(self.file)
        try:
            facts = path.stat()
        except OSError:
            raise InputError(f"{path}: there is no such file") from None
        return _read(type(self), path, self.settings(), facts.st_mtime_ns, facts.st_size)

    def settings(self) -> tuple[Hashable, ...]:
        """Return what reading depends on beside the file."""
        return ()

    @classmethod
    @abstractmethod
    def read(cls, path: Path, *settings: Any) -> Any:
        """Return the ground in a file.

        Raises
        ------
        InputError
            If the file cannot be read or holds no ground; with line where there is one.
        """


@lru_cache(maxsize=8)
def _read(
    surface: type[FileSurface],
    path: Path,
    settings: tuple[Hashable, ...],
    changed: int,
    size: int,
) -> Any:
    """Return the ground of a file that was changed at a time and has a size."""
    return surface.read(path, *settings)
