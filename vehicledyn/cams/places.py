"""Where in its file a problem of a cam stands."""

from __future__ import annotations

from vehicledyn.base.problems import START, Place, Problem, dotted
from vehicledyn.base.yaml import Document


def problem_at(document: Document, place: Place, message: str, *, at_key: bool = False) -> Problem:
    """Return a problem with the line of its place, or of the nearest one around it.

    Parameters
    ----------
    document
        The file.
    place
        Place of the value; it may be missing.
    message
        What is wrong.
    at_key
        Whether to point at the key rather than at its value.
    """
    size = len(place)
    while size and place[:size] not in document.keys and place[:size] not in document.values:
        size -= 1
    known = place[:size]
    key = document.keys.get(known)
    value = document.values.get(known)
    mark = (key or value) if at_key or value is None else value
    if not at_key and key is not None and value is not None and value.line != key.line:
        mark = key
    return Problem(document.name, mark or START, dotted(place), message)
