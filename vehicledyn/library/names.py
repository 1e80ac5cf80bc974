"""Names of the files that come with the program, and where they are.

A file is named by its stem, such as ``iltis_slalom``, or by its place without the ending, such as
``systems/bicycle``. A stem is unique among the files of one kind.
"""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

from vehicledyn.base.errors import InputError, unknown_name

Kind = Literal["scenario", "study", "system", "profile"]

_FOLDERS: dict[str, tuple[Kind, str]] = {
    "scenarios": ("scenario", "*.yaml"),
    "scenarios/systems": ("scenario", "*.yaml"),
    "scenarios/studies": ("study", "*.yaml"),
    "systems": ("system", "*.yaml"),
    "profiles": ("profile", "*.csv"),
}


@dataclass(frozen=True)
class LibraryFile:
    """A file of the library: its name, its place in the library without ending, and its path."""

    name: str
    kind: Kind
    place: str
    path: Path

    def sentence(self) -> str:
        """Return what the file says it is about: its title, or the source of a profile."""
        mark = "# source: " if self.kind == "profile" else "title: "
        with self.path.open(encoding="utf-8") as lines:
            found = next((line for line in lines if line.startswith(mark)), mark)
        return found.removeprefix(mark).strip().strip("\"'")


@cache
def library_folder() -> Path:
    """Return the folder of the library: inside an installed package, or the clone around it."""
    inside = Path(__file__).parent
    return inside if (inside / "scenarios").is_dir() else inside.parents[1]


@cache
def entries(*kinds: Kind) -> tuple[LibraryFile, ...]:
    """Return the files of these kinds, or all, ordered by kind as given and by name."""
    found = [
        LibraryFile(path.stem, kind, f"{folder}/{path.stem}", path)
        for folder, (kind, pattern) in _FOLDERS.items()
        for path in (library_folder() / folder).glob(pattern)
    ]
    wanted = kinds or tuple(dict.fromkeys(kind for kind, _ in _FOLDERS.values()))
    chosen = (entry for entry in found if entry.kind in wanted)
    return tuple(sorted(chosen, key=lambda entry: (wanted.index(entry.kind), entry.name)))


def find_entry(name: str, kinds: Sequence[Kind]) -> LibraryFile | None:
    """Return the file of this name or place, None if there is none.

    Where files of several kinds have the name, the first of ``kinds`` decides.
    """
    return next((entry for entry in entries(*kinds) if name in (entry.name, entry.place)), None)


def names_of(*kinds: Kind) -> tuple[str, ...]:
    """Return the names of the files of these kinds."""
    return tuple(dict.fromkeys(entry.name for entry in entries(*kinds)))


def locate(name: str, kinds: Sequence[Kind], others: Sequence[str] = ()) -> Path:
    """Return the file that a name means: a file of the user's, or else one of the library.

    A path that exists is taken as it is; a name without an ending is then looked for as NAME.yaml
    in its folder, and last in the library.

    Parameters
    ----------
    name
        Path, or name of a file of the library.
    kinds
        Kinds of files that would do; the first that has the name decides.
    others
        Further names that would do, for the message.

    Raises
    ------
    InputError
        If a name without an ending is unknown, or there is no such file but one of the library
        is named so.
    """
    path = Path(name)
    if not path.name:
        raise InputError(f"'{name}' names no file; give the name of one")
    try:
        path.with_name(f"{path.name}.yaml").exists()
    except OSError as error:
        raise InputError(f"{reprlib.repr(name)} names no file: {error.strerror}") from None
    if path.is_symlink() or (path.exists() and not path.is_dir()):
        return path
    if path.suffix:
        return _missing(path, kinds)
    beside = path.with_name(f"{path.name}.yaml") if path.name else path
    if beside.is_file():
        return beside
    entry = find_entry(name, kinds)
    if entry is None and path.exists():
        return path
    if entry is None:
        words = unknown_name(" or ".join(kinds), name, (*others, *names_of(*kinds)))
        raise InputError(f"'{name}' is not a file; {words}")
    return entry.path


def _missing(path: Path, kinds: Sequence[Kind]) -> Path:
    """Return a path at which nothing is, unless the library has a file of that name."""
    words = library_hint(path, kinds)
    if words:
        raise InputError(f"{path}: {words}")
    return path


def library_hint(path: Path, kinds: Sequence[Kind]) -> str:
    """Return that a file is missing of which the library has one, empty if it has none."""
    entry = find_entry(path.stem, kinds)
    if entry is None or path.name != entry.path.name:
        return ""
    return f"there is no such file; the library has one of this name: write '{entry.name}'"
