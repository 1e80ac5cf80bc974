"""The verb "eig": eigenmodes of a vehicle about straight running at given speeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.base.units import shown
from vehicledyn.run.prepare import (
    Point,
    Prepared,
    Progress,
    equilibrium_point,
    prepare,
    start_point,
)
from vehicledyn.run.system_subject import SystemSubject
from vehicledyn.run.vehicle import Target
from vehicledyn.scenario import LoadedScenario
from vehicledyn.solve.kernel import Backend
from vehicledyn.solve.linearise import linearise
from vehicledyn.solve.modes import Mode, eigenmodes

_HEAD = f"{'eigenvalue [1/s]':>34} {'undamped':>12} {'damping':>9}  states"
_STABLE = 1e-6
_NEAR_ZERO = 1e-4
"""A free motion has this eigenvalue at most where the speed slowly falls [1/s]."""


@dataclass(frozen=True)
class ModesAtSpeed:
    """Modes about straight running at one speed [m/s]."""

    speed: float
    modes: tuple[Mode, ...]

    @property
    def unstable(self) -> list[Mode]:
        """Modes that grow."""
        return [m for m in self.modes if m.eigenvalue.real > _STABLE]


@dataclass(frozen=True)
class ModesReport:
    """Modes of a vehicle at several speeds."""

    model: str
    speeds: list[ModesAtSpeed]

    def as_text(self) -> str:
        """Return a table of modes for each speed."""
        return "\n\n".join(self._table(entry) for entry in self.speeds)

    def as_dict(self) -> dict[str, Any]:
        """Return the modes as plain data."""
        return {
            "model": self.model,
            "speeds": [
                {"speed": entry.speed, "modes": [_mode_dict(m) for m in entry.modes]}
                for entry in self.speeds
            ],
        }

    def _table(self, entry: ModesAtSpeed) -> str:
        zeros = sum(1 for m in entry.modes if abs(m.eigenvalue) < _NEAR_ZERO)
        verdict = f"{len(entry.unstable)} unstable" if entry.unstable else "all others stable"
        head = f"{self.model} at {shown(entry.speed, 'm/s')}: {zeros} zeros, {verdict}"
        return "\n".join([head, _HEAD, *(_mode_line(m) for m in entry.modes)])


def find_modes(
    target: Target, *, speeds: list[float], backend: Backend, progress: Progress
) -> ModesReport:
    """Return the modes of a vehicle about its steady motion straight ahead, or of a system.

    A system is linearised about the start that its scenario names, else about the equilibrium
    near its start values.

    Parameters
    ----------
    target
        A scenario or a model.
    speeds
        Forward speeds [m/s]; empty for the scenario's own.
    backend, progress
        As for a run.

    Raises
    ------
    NumericalError
        If there is no steady motion at a speed.
    """
    prepared = prepare(target, backend=backend, progress=progress)
    own = target.scenario.speed or 0.0 if isinstance(target, LoadedScenario) else 0.0
    found = []
    for speed in speeds or [own]:
        progress(f"linearising at {shown(speed, 'm/s')}", None)
        point = _reference_point(prepared, target, speed)
        linear = linearise(
            prepared.equations,
            prepared.kernel.parameters,
            prepared.subject.balance_time,
            point.state,
            point.unknowns,
            derivatives=prepared.derivatives,
        )
        found.append(ModesAtSpeed(speed, eigenmodes(linear.matrix, linear.names)))
    return ModesReport(prepared.equations.name, found)


def _reference_point(prepared: Prepared, target: Target, speed: float) -> Point:
    """Return the point to linearise about: of a system the start that its scenario names."""
    if isinstance(prepared.subject, SystemSubject):
        start = target.scenario.start if isinstance(target, LoadedScenario) else None
        return start_point(prepared, speed, start or "static")
    return equilibrium_point(prepared, speed, "steady" if speed > 0.0 else "static")


def _mode_line(mode: Mode) -> str:
    value = mode.eigenvalue
    pair = f"{value.real:.6f} ± {value.imag:.6f}i" if mode.is_oscillation else f"{value.real:.6f}"
    states = ", ".join(mode.dominant[:3])
    if mode.is_zero:
        return f"{'0':>34} {'':>12} {'':>9}  {states}"
    if not mode.is_oscillation:
        return f"{pair:>34} {'':>12} {'':>9}  {states}"
    return f"{pair:>34} {mode.frequency:>9.4f} Hz {mode.damping_ratio:>9.4f}  {states}"


def _mode_dict(mode: Mode) -> dict[str, Any]:
    return {
        "real": mode.eigenvalue.real,
        "imaginary": mode.eigenvalue.imag,
        "is_pair": mode.is_oscillation,
        "frequency_hz": mode.frequency,
        "damping_ratio": mode.damping_ratio,
        "dominant_states": list(mode.dominant),
        "shape": [[float(v.real), float(v.imag)] for v in map(complex, mode.shape)],
    }
