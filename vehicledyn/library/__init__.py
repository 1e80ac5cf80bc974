"""The library: scenarios, studies, systems and profiles that come with the program, by name."""

from vehicledyn.library.names import (
    Kind,
    LibraryFile,
    entries,
    find_entry,
    library_folder,
    library_hint,
    locate,
    names_of,
)

__all__ = [
    "Kind",
    "LibraryFile",
    "entries",
    "find_entry",
    "library_folder",
    "library_hint",
    "locate",
    "names_of",
]
