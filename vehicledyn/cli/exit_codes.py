"""Exit codes of the verbs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.errors import MissingPartError, NumericalError, StoppedError, VehicledynError

if TYPE_CHECKING:
    from vehicledyn.results.labelled.data import LabelledData

OK, NEGATIVE, INPUT, NUMERICAL, MISSING, SOME_FAILED, BUG, INTERRUPTED = 0, 1, 2, 3, 4, 5, 70, 130

CODES_OF_VERDICTS = {"equal": OK, "different": NEGATIVE, "unusable": INPUT}
"""Of comparisons."""

_OF_ERRORS = {NumericalError: NUMERICAL, MissingPartError: MISSING, StoppedError: INTERRUPTED}
_OF_STATUS = {
    "ok": OK,
    "interrupted": INTERRUPTED,
    "failed": NUMERICAL,
    "partial": NUMERICAL,
}
"""All others are names of events that end a run, such as "derailed"."""


def code_of_error(error: VehicledynError) -> int:
    """Return the exit code that an error means."""
    return next((code for kind, code in _OF_ERRORS.items() if isinstance(error, kind)), INPUT)


def code_of_result(data: LabelledData) -> int:
    """Return the exit code of a verb that has this result."""
    code = _OF_STATUS.get(data.status, NEGATIVE)
    counts = getattr(data.report, "counts", {})
    return SOME_FAILED if code == OK and counts.get("failed") else code
