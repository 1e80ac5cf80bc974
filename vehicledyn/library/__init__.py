"""The library: scenarios, studies, systems and profiles that come with the program, by name."""

from vehicledyn.library.names import (
    Entry,
    Kind,
    entries,
    find_entry,
    library_folder,
    library_hint,
    locate,
    names_of,
)

__all__ = [
    "Entry",
    "Kind",
    "entries",
    "find_entry",
    "library_folder",
    "library_hint",
    "locate",
    "names_of",
]
