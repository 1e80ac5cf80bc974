"""Irregularities from the spectra of ERRI B 176."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field, model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.base.validation_messages import Complaint, complain
from vehicledyn.rail.track.track_set import IrregularitySet

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.rail.track.track_tables import TabledShift

CORNER_C, CORNER_R, CORNER_S = 0.8246, 0.0206, 0.4380
"""Ω_c, Ω_r and Ω_s [rad/m]."""

HALF_BASE = 0.75
"""b, half the distance of the rails to which the spectrum of the cross level refers [m]."""

ALIGNMENT = {"low": 2.119e-7, "high": 6.125e-7}
LEVEL = {"low": 4.032e-7, "high": 1.080e-6}
"""A_A and A_V, how rough alignment and level are [m rad]."""

LONGEST_RECORD = 100_000.0
_STREAMS = {"alignment": 1, "level": 2, "cross_level": 3}
_VALUES_IN_SHORTEST = 20


def spectra(
    level: Literal["low", "high"], frequency: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Return the one-sided spectra of alignment, level and cross level [m²/(rad/m)].

    S_A = A_A Ω_c² / ((Ω_r² + Ω²) (Ω_c² + Ω²)), S_V the same with A_V, and of the angle about the
    track's axis S_C = A_V Ω_c² Ω² / (b² (Ω_r² + Ω²) (Ω_c² + Ω²) (Ω_s² + Ω²)); the cross level is
    the angle times 2 b. One-sided means that the variance is the integral over Ω > 0.

    Parameters
    ----------
    level
        "low" for good, "high" for poor track of main lines.
    frequency
        Ω, any shape [rad/m].

    References
    ----------
    ERRI B 176 RP 1 (1989), Benchmark problem: results and assessment; Claus and Schiehlen (1998),
    Vehicle System Dynamics 29 (suppl.), 538-552. The report was not at hand: formulas and all
    constants, b = 0.75 m included, were compared with four public programs that state them
    independently of each other, as spectra of ERRI B 176 or as the German ones of low and high
    disturbance. These superpose waves of amplitude √(2 S ΔΩ) over Ω > 0, so the spectra are
    one-sided. With wavelengths of 3 to 25 m the level deviates by 1.0 mm (low) and 1.6 mm (high)
    in the root mean square, the size that UIC 518 knows.
    """
    square = frequency * frequency
    common = CORNER_C**2 / ((CORNER_R**2 + square) * (CORNER_C**2 + square))
    vertical = LEVEL[level] * common
    angle = vertical * square / (HALF_BASE**2 * (CORNER_S**2 + square))
    return {
        "alignment": ALIGNMENT[level] * common,
        "level": vertical,
        "cross_level": 4.0 * HALF_BASE**2 * angle,
    }


@register("irregularity", "erri_b176")
class ErriB176(IrregularitySet):
    """Random irregularities with the spectra of ERRI B 176, by a seed."""

    level: Literal["low", "high"] = Field(description="How rough the track is")
    seed: int = Field(ge=0, description="Seed of the random phases; the same seed, the same track")
    length: float = quantity("m", "Length of the record", gt=0.0, le=LONGEST_RECORD)
    start: float = quantity("m", "Where it begins on the track", default=0.0)
    fade: float = quantity("m", "Length over which it comes and goes at its ends", ge=0.0)
    shortest: float = quantity("m", "Shortest wavelength", default=3.0, gt=0.1)
    longest: float = quantity("m", "Longest wavelength", default=25.0, gt=0.1)
    quantities: tuple[Literal["alignment", "level", "cross_level"], ...] = Field(
        default=("alignment", "level", "cross_level"), description="Which of them there are"
    )

    @model_validator(mode="after")
    def _fits_together(self) -> ErriB176:
        wrong = []
        if self.longest <= self.shortest:
            wrong.append(("longest", f"must be longer than the shortest, {self.shortest:g} m"))
        elif self.length < 2.0 * self.longest:
            words = f"must be twice the longest wavelength at least, {2.0 * self.longest:g} m"
            wrong.append(("length", words))
        if 2.0 * self.fade > self.length:
            wrong.append(("fade", f"is longer than half the record of {self.length:g} m"))
        if not self.quantities:
            wrong.append(("quantities", f"name some of {', '.join(_STREAMS)}"))
        if wrong:
            raise complain("irregularity", [Complaint((key,), words, None) for key, words in wrong])
        return self

    def shift(self, folder: Path) -> TabledShift:
        """Return the displacement of the rails."""
        from vehicledyn.rail.irregularities.irregularity import rails_of

        return rails_of(self.start, self.length / self.count, self.records(), self.fade)

    @property
    def count(self) -> int:
        """Number of steps of the record."""
        return math.ceil(self.length * _VALUES_IN_SHORTEST / self.shortest)

    def records(self) -> dict[str, NDArray[np.float64]]:
        """Return the record of each quantity before it fades, shape (n,) [m]."""
        import numpy as np

        from vehicledyn.base.numbers.random_waves import synthesise

        first = math.ceil(self.length / self.longest - 1e-9)
        last = math.floor(self.length / self.shortest + 1e-9)
        numbers = np.arange(first, last + 1).astype(float)
        found = spectra(self.level, np.asarray(2.0 * math.pi / self.length * numbers))
        return {
            name: synthesise(
                found[name],
                first,
                length=self.length,
                count=self.count,
                stream=(self.seed, _STREAMS[name]),
            )
            for name in self.quantities
        }
