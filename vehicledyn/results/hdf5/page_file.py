"""Where a page may be written: over nothing but a page of its own kind, and whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import write_whole
from vehicledyn.results.hdf5.output import write_failed

_HEAD = 2048  # bytes


def check_page(target: Path, kind: str) -> None:
    """Test that a page can be written; call it before anything is computed.

    Parameters
    ----------
    target
        The page.
    kind
        What the page is, such as "report": a file that is there is written over only if its
        element ``<meta name="generator" content="vehicledyn KIND ...">`` says the same.

    Raises
    ------
    InputError
        If the folder is missing or not writable, or another file or a folder has the name.
    """
    if target.is_dir():
        raise InputError(f"{target}: is a folder; give the name of a page in it")
    if not target.parent.is_dir():
        raise InputError(f"{target}: the folder {target.parent} does not exist; create it first")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise InputError(f"{target}: no permission to write there; choose another")
    if target.exists() and not _is_of_kind(target, kind):
        raise InputError(f"{target}: exists and is no {kind}, so it is kept; choose another")


def write_page(target: Path, text: str) -> None:
    """Write a page; a page that was there stays until the new one is whole.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    try:
        write_whole(target, text, errors="replace")
    except OSError as error:
        raise write_failed(target, error) from error


def _is_of_kind(target: Path, kind: str) -> bool:
    mark = f'<meta name="generator" content="vehicledyn {kind}'.encode()
    try:
        with target.open("rb") as file:
            start = file.read(_HEAD)
    except OSError:
        return False
    return not start or mark in start
