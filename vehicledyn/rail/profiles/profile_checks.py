"""What is wrong with a profile, by name or in a file."""

from __future__ import annotations

from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import is_count
from vehicledyn.rail.profiles.profile_names import Kind, check_name, is_name
from vehicledyn.rail.profiles.profile_reading import ProfileReading


def file_problems(text: str, kind: Kind, reading: ProfileReading) -> list[str]:
    """Return what is wrong with a profile, by name or in a file, one line each.

    Parameters
    ----------
    text, kind
        As for :func:`vehicledyn.rail.profiles.open_profile.open_profile`.
    reading
        How the points of a file become a profile.
    """
    try:
        if is_name(text) or not (Path(text).suffix or Path(text).exists()):
            check_name(text, kind)
            return []
        from vehicledyn.rail.profiles.open_profile import open_profile

        open_profile(text, kind, reading)
    except InputError as error:
        return [line for line in str(error).splitlines() if not is_count(line)]
    return []
