"""Stability of an equilibrium, by the modes of small motions about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.analyse.linearise import linearise
from vehicledyn.analyse.modes import Mode, eigenmodes
from vehicledyn.analyses.linear.mode_report import NEAR_ZERO, STABLE
from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import InputError, NumericalError

_LISTED, _NAMED = 3, 6
"""Growing modes, and states that are indifferent, that are named."""


@dataclass(frozen=True)
class Stability:
    """How small motions about an equilibrium go on, counted by modes, and which of them grow.

    ``unknown`` says why it could not be found, else it is empty. Modes that neither grow nor
    decay are free motions and undamped oscillations; ``indifferent`` are their largest states.
    """

    growing: tuple[Mode, ...] = ()
    decaying: int = 0
    neutral: int = 0
    unknown: str = ""
    indifferent: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """One word: stable, unstable, neutral or unknown."""
        if self.unknown:
            return "unknown"
        if self.growing:
            return "unstable"
        return "neutral" if self.neutral else "stable"

    def as_text(self) -> str:
        """Return verdict, counts and the growing modes, fastest first."""
        if self.unknown:
            return f"stability not known: {self.unknown}"
        counts = [f"{_modes(self.decaying, 'decays', 'decay')}"]
        if self.neutral:
            free = _modes(self.neutral, "neither grows nor decays", "neither grow nor decay")
            which = f" in {', '.join(self.indifferent[:_NAMED])}" if self.indifferent else ""
            more = ", ..." if len(self.indifferent) > _NAMED else ""
            counts.append(f"{free}{which}{more} (free or undamped)")
        if not self.growing:
            return f"{self.verdict}: {', '.join(counts)}"
        fastest = [
            f"{_value(mode)} with {', '.join(mode.dominant[:_LISTED])}"
            for mode in self.growing[:_LISTED]
        ]
        counts.insert(0, _modes(len(self.growing), "grows", "grow"))
        return f"unstable: {', '.join(counts)}; fastest {'; '.join(fastest)}"

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain data in SI."""
        return {
            "verdict": self.verdict,
            "unknown": self.unknown,
            "decaying": self.decaying,
            "neutral": self.neutral,
            "indifferent": list(self.indifferent),
            "growing": [
                {
                    "real": mode.eigenvalue.real,
                    "imaginary": mode.eigenvalue.imag,
                    "states": list(mode.dominant),
                }
                for mode in self.growing
            ],
        }


def _modes(number: int, one: str, several: str) -> str:
    return f"{number} mode {one}" if number == 1 else f"{number} modes {several}"


def stability_of(prepared: Prepared, point: AssembledPoint) -> Stability:
    """Return the stability of an equilibrium, by the eigenvalues of the linearised equations.

    A mode grows or decays where the real part of its eigenvalue is beyond 1e-6 /s, and its size
    beyond that of a free motion on which the speed slowly falls.
    """
    try:
        linear = linearise(
            prepared.equations,
            prepared.kernel.parameters,
            prepared.subject.balance_time,
            point.state,
            point.unknowns,
            derivatives=prepared.derivatives,
        )
    except (InputError, NumericalError) as error:
        return Stability(unknown=str(error))
    modes = eigenmodes(linear.matrix, linear.names)
    moving = [m for m in modes if abs(m.eigenvalue) >= NEAR_ZERO]
    growing = [m for m in moving if m.eigenvalue.real > STABLE]
    decaying = sum(1 for m in moving if m.eigenvalue.real < -STABLE)
    growing.sort(key=lambda mode: -mode.eigenvalue.real)
    still = [m for m in modes if m not in moving or abs(m.eigenvalue.real) <= STABLE]
    names = dict.fromkeys(m.dominant[0] for m in still if m.dominant)
    return Stability(tuple(growing), decaying, len(still), indifferent=tuple(names))


def _value(mode: Mode) -> str:
    value = mode.eigenvalue
    rate = f"{value.real:+.4g}"
    return f"{rate} ± {value.imag:.4g}i /s" if mode.is_oscillation else f"{rate} /s"
