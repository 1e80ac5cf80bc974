"""Names that look like calls: ``rig(left.toe_gain, parallel, 0 mm, travel=20 mm)``."""

from __future__ import annotations

import re
from collections.abc import Collection

from vehicledyn.base.errors import InputError, unknown_name

_CALL = re.compile(r"\w+\((.*)\)")


def called_parts(
    name: str, form: str, counts: Collection[int], settings: Collection[str]
) -> tuple[list[str], dict[str, str]]:
    """Return the parts between the brackets of a name, and the settings among them by key.

    Parameters
    ----------
    name
        What was asked for.
    form
        How to write it.
    counts
        Numbers of parts that there may be, settings aside.
    settings
        Keys that are known.

    Raises
    ------
    InputError
        If there are other numbers of parts, or other keys, or one twice.

    Examples
    --------
    >>> called_parts("rig(left.camber, roll, travel=2 mm)", "rig(...)", (2, 3), ("travel",))
    (['left.camber', 'roll'], {'travel': '2 mm'})
    """
    match = _CALL.fullmatch(name)
    parts = [part.strip() for part in match[1].split(",")] if match else []
    given = [part.partition("=") for part in parts if "=" in part]
    parts = [part for part in parts if "=" not in part]
    if len(parts) not in counts or not all(parts):
        raise InputError(f"'{name}': write {form}")
    found = {key.strip(): value.strip() for key, _, value in given}
    if len(found) < len(given):
        raise InputError(f"'{name}': a setting is given twice")
    for key in found:
        if key not in settings:
            raise InputError(f"'{name}': {unknown_name('setting', key, settings)}")
    return parts, found
