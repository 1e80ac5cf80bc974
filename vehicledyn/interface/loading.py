"""Scenarios and models as values that can be changed and run."""

from __future__ import annotations

from typing import Any

from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.targets import Source, Target, read_target


@checked
def load(source: Source, *, set: Settings | None = None, **settings: Any) -> Target:
    """Return a scenario or model, checked completely, to change and to hand to analyses.

    ``load("iltis_slalom").changed(speed="10 m/s")`` is another scenario; the file stays as it is.

    Parameters
    ----------
    source
        Path or name of a scenario or model, or a System.
    set
        Values by dotted keys, such as ``{"solver.step": "1 ms"}``.
    settings
        Values by field, such as ``speed="20 m/s"``.

    Raises
    ------
    InputError
        If there is none, or anything is wrong with it.
    """
    return read_target(source, override_texts(set, settings), ("scenario", "system"))
