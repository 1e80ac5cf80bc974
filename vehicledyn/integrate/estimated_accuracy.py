"""What the watch of a run with a fixed step found of its accuracy, and how it is put in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

ENERGY = "energy_drift"
"""Name of the energy's balance among key figures."""


@dataclass(frozen=True)
class Accuracy:
    """What the watch found.

    ``verdict`` is "accurate", "inaccurate" or "diverged"; ``error`` the estimated error of the
    worst key figure or channel, ``worst``, as a part of its size; ``step`` the one to take instead
    [s], None where the present one will do or no shorter one is known to; ``extra_steps`` were
    taken to find out. ``finest`` is the shortest step that was tried where even that does not
    settle the figure [s]. ``failure`` says why a run with half the step cannot go on, where no
    step is known that can.
    """

    verdict: str
    error: float
    worst: str
    step: float | None = None
    extra_steps: int = 0
    finest: float | None = None
    failure: str = ""

    @property
    def warning(self) -> str:
        """A sentence for a person; empty for an accurate run."""
        if self.verdict == "accurate":
            return ""
        if self.failure:
            return f"the result depends on the step: with half of it the run fails, {self.failure}"
        advice = "" if self.step is None else f"; take a step of {self.step * 1e3:.4g} ms"
        if not self.worst:
            return f"the run ends early only because its step is too long{advice}"
        if self.worst == f"'{ENERGY}'":
            return self._of_energy(advice)
        size = f"about {100.0 * self.error:.2g} %" if self.error < 1.0 else "its own size or more"
        if self.finest is not None:
            return (
                f"{self.worst} is off by {size}, and steps down to {self.finest * 1e3:.4g} ms do "
                "not settle it: something abrupt decides it, such as an impact or a switch, or "
                "motions that drive errors apart; smooth it, or read the figure as uncertain"
            )
        return f"the step is too long: {self.worst} is off by {size}{advice}"

    def _of_energy(self, advice: str) -> str:
        """Return the sentence for a balance of the energy that does not hold."""
        size = f"{100.0 * self.error:.2g} %" if self.error < 1.0 else "all"
        words = f"energy comes from nowhere or is lost, about {size} of what is exchanged"
        if self.finest is None:
            return f"the step is too long: {words} ('{ENERGY}'){advice}"
        return (
            f"{words} ('{ENERGY}'), and steps down to {self.finest * 1e3:.4g} ms do not settle it"
        )

    def as_attributes(self) -> dict[str, str | float | int | None]:
        """Return what a result file keeps of it, by name."""
        return {
            "accuracy": self.verdict,
            "estimated_error": self.error,
            "least_accurate": self.worst.strip("'"),
            "recommended_step": self.step,
            "accuracy_steps": self.extra_steps,
        }


def worst_of(parts: Sequence[Accuracy | None]) -> Accuracy | None:
    """Return what is to be said of a run in parts, None where nothing is known of any."""
    known = [part for part in parts if part is not None]
    if not known:
        return None
    worst = max(known, key=lambda part: (part.verdict != "accurate", part.error))
    steps = [part.step for part in known if part.step is not None]
    extra = sum(part.extra_steps for part in known)
    return replace(worst, step=min(steps, default=None), extra_steps=extra)
