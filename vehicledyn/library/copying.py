"""Copies of files of the library, together with all files that they refer to."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import copy_whole, folder_for_files
from vehicledyn.base.nested import leaves
from vehicledyn.base.yaml import read_yaml
from vehicledyn.library.names import LibraryFile, library_folder


def copy_entry(entry: LibraryFile, folder: Path) -> list[Path]:
    """Copy a file and all it refers to; return the copies, that of the file itself first.

    The copies keep their places relative to each other, so that references stay valid.

    Parameters
    ----------
    entry
        The file.
    folder
        Where the copies go; made if it is missing.

    Raises
    ------
    InputError
        If a file is there already (then nothing is written), or one cannot be written.
    """
    sources = referenced(entry.path)
    common = Path(os.path.commonpath([source.parent for source in sources]))
    copies = {folder / source.relative_to(common): source for source in sources}
    taken = [str(copy) for copy in copies if copy.exists() or copy.is_symlink()]
    if taken:
        exist = f"{', '.join(taken)} exist" + ("s" if len(taken) == 1 else "")
        raise InputError(f"{exist} already, so nothing was copied; give another folder")
    for copy, source in copies.items():
        try:
            with folder_for_files(copy.parent):
                copy_whole(source, copy)
        except OSError as error:
            raise InputError(f"{copy}: cannot be written: {error.strerror}") from None
    return list(copies)


_LONGEST_NAME = 255
"""Characters of the longest name of a file; longer texts are expressions."""


def referenced(path: Path) -> list[Path]:
    """Return a file of the library and all that it refers to, directly or through others."""
    root, waiting = library_folder().resolve(), [path.resolve()]
    found: dict[Path, None] = {}
    while waiting:
        file = waiting.pop(0)
        if file in found or not file.is_relative_to(root):
            continue
        found[file] = None
        if file.suffix == ".yaml":
            texts = filter(_may_name_file, leaves(read_yaml(file).data))
            named = (file.parent / text for text in texts)
            waiting += [other.resolve() for other in named if other.is_file()]
    return list(found)


def _may_name_file(text: Any) -> bool:
    is_short = isinstance(text, str) and "\n" not in text and len(text) <= _LONGEST_NAME
    return is_short and bool(Path(text).suffix)
