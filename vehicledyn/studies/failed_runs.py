"""Words on runs that a search asked for: those that failed, and those known from before."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity

_LISTED = 4
"""Failed runs that are described one by one."""


def with_values(quantities: Iterable[Quantity], values: Iterable[float]) -> str:
    """Return the values of a run's parameters in words.

    >>> with_values([Quantity("mass", "kg", "Mass")], [2.0])
    'with mass = 2 kg'
    """
    pairs = zip(quantities, values, strict=True)
    return "with " + ", ".join(f"{q.name} = {shown(float(v), q.unit)}" for q, v in pairs)


def known_runs(count: int) -> list[str]:
    """Return a line on runs that were known from before, none if there were none."""
    if not count:
        return []
    return ["1 run was known from before" if count == 1 else f"{count} runs were known from before"]


def failure_notes(failures: Sequence[str]) -> list[str]:
    """Return a note on each of the first failed runs, and one on all others.

    >>> failure_notes(["overturned"] * 6)[-1]
    '2 further runs failed; all were retreated from'
    """
    found = [f"a run failed {reason}" for reason in failures[:_LISTED]]
    if more := len(failures) - _LISTED:
        words = "1 further run" if more == 1 else f"{more} further runs"
        found += [f"{words} failed; all were retreated from"] * (more > 0)
    return found
