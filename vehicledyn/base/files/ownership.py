"""Who else could change a file: owners and modes of the file, its folders and links on the way.

Code that is loaded and keys that are used must come from files that only this user and the
system's administrator can write.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

_ROOT = 0
_MOST_LINKS = 40


def writable_by_others(path: Path) -> str:
    """Return why users other than this one and root could change what is at a path.

    Parameters
    ----------
    path
        A file or folder; where it does not exist, the existing part of its path is examined.

    Returns
    -------
    str
        The reason with the place; empty if there is none, and on systems without owners and
        modes of this kind.
    """
    if not hasattr(os, "geteuid"):
        return ""
    waiting = list(reversed(path.absolute().parts[1:]))
    place, links = Path(path.absolute().anchor), 0
    reason = _reason(place)
    while waiting and not reason:
        name = waiting.pop()
        if name == os.pardir:
            place = place.parent
            continue
        place = place / name
        if not place.is_symlink():
            reason = _reason(place)
            continue
        links += 1
        reason = _owner_reason(place, place.lstat()) if links < _MOST_LINKS else f"{place}: a loop"
        target = place.readlink()
        place = Path(target.anchor) if target.is_absolute() else place.parent
        waiting += reversed(target.parts[1:] if target.is_absolute() else target.parts)
    return reason


def _reason(place: Path) -> str:
    try:
        facts = place.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return ""
    except OSError as error:
        return f"{place}: {error.strerror}"
    return _owner_reason(place, facts) or _mode_reason(place, facts)


def _owner_reason(place: Path, facts: os.stat_result) -> str:
    if facts.st_uid in (_ROOT, os.geteuid()):
        return ""
    return f"{place} belongs to another user (number {facts.st_uid})"


def _mode_reason(place: Path, facts: os.stat_result) -> str:
    is_folder = stat.S_ISDIR(facts.st_mode)
    if is_folder and facts.st_mode & stat.S_ISVTX:
        return ""  # others can add to it, but not replace what is there
    open_to_group = facts.st_mode & stat.S_IWGRP and not _is_private(facts)
    if not open_to_group and not facts.st_mode & stat.S_IWOTH:
        return ""
    kind = "folder" if is_folder else "file"
    return f"others can write to the {kind} {place} (mode {stat.S_IMODE(facts.st_mode):04o})"


def _is_private(facts: os.stat_result) -> bool:
    """Return whether the group of a file is root's, or that of its owner alone."""
    if facts.st_gid == _ROOT:
        return True
    import grp
    import pwd

    try:
        group, user = grp.getgrgid(facts.st_gid), pwd.getpwuid(facts.st_uid)
    except KeyError:
        return False
    return group.gr_name == user.pw_name and set(group.gr_mem) <= {user.pw_name}
