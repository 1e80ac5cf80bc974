"""One line of the validation table: a reference, what was computed, the band, the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Comparison:
    """A reference and what was computed for it, as a person reads them."""

    source: str
    quantity: str
    reference: str
    computed: str
    band: str
    passes: bool

    @property
    def verdict(self) -> str:
        """PASS or FAIL."""
        return "PASS" if self.passes else "FAIL"


@dataclass(frozen=True)
class Group:
    """Comparisons of one subject; ``note`` says where the bands come from."""

    title: str
    note: str
    rows: tuple[Comparison, ...]

    def failures(self) -> list[Comparison]:
        """Return the rows out of their band."""
        return [row for row in self.rows if not row.passes]


def figure(source, quantity, *, reference, computed, band, unit, digits=3):
    """Compare two numbers in the unit in which they are printed."""
    return Comparison(
        source,
        quantity,
        f"{reference:.{digits}f} {unit}",
        f"{computed:.{digits}f} {unit}",
        f"± {band:g} {unit}",
        bool(abs(computed - reference) <= band),
    )


def deviation(source, quantity, *, reference, largest, band, unit):
    """Compare many numbers at once by their largest deviation; ``reference`` says what they are."""
    return Comparison(
        source,
        quantity,
        reference,
        f"largest deviation {size(float(largest), band)} {unit}",
        f"± {band:g} {unit}",
        bool(largest <= band),
    )


def exactly(source, quantity, reference, computed):
    """Compare two counts or texts."""
    return Comparison(
        source, quantity, str(reference), str(computed), "exact", reference == computed
    )


def size(value, band):
    """Return a deviation in two digits, or a decade above it where it is far below the band.

    Rounding differs between processors, so digits of rounding errors would change the report.
    """
    if value == 0.0:
        return "0"
    if value > 0.01 * band:
        return f"{value:.1e}"
    return f"< {10.0 ** math.ceil(math.log10(max(value, 1e-4 * band))):.0e}"
