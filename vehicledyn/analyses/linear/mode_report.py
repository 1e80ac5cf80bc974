"""Eigenmodes as text and as plain data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.modes import Mode
from vehicledyn.base.units import shown
from vehicledyn.results.tables.mode_table import ModeCase, ModeTable

STABLE = 1e-6
"""Real part above which a mode counts as growing [1/s]."""

_HEAD = f"{'eigenvalue [1/s]':>34} {'undamped':>12} {'damping':>9}  shape"
NEAR_ZERO = 1e-4
"""A free motion has this eigenvalue at most where the speed slowly falls [1/s]."""

_TOLD = 4
_SMALL = 0.005
_ZERO_WORDS = {"free": "0 (free)", "drift": "0 (drift)"}


@dataclass(frozen=True)
class ModesAtSpeed:
    """Modes about one reference motion at a speed [m/s]; ``remark`` says if it is not steady."""

    speed: float
    modes: tuple[Mode, ...]
    setting: str = ""
    remark: str = ""

    @property
    def unstable(self) -> list[Mode]:
        """Modes that grow."""
        return [m for m in self.modes if m.eigenvalue.real > STABLE]


@dataclass(frozen=True)
class ModesReport:
    """Modes of a model in one or several cases; ``table`` holds their shapes.

    ``has_speed`` distinguishes a vehicle from a system, which no single speed describes.
    """

    model: str
    speeds: list[ModesAtSpeed]
    table: ModeTable
    has_speed: bool = True

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks and warnings of all cases."""
        return tuple(line for entry in self.speeds for line in entry.remark.splitlines())

    def as_text(self) -> str:
        """Return a table of modes for each case."""
        pairs = zip(self.speeds, self.table.cases, strict=True)
        return "\n\n".join(self._lines(entry, case) for entry, case in pairs)

    def as_dict(self) -> dict[str, Any]:
        """Return the modes as plain data."""
        return {
            "model": self.model,
            "states": [q.name for q in self.table.states],
            "speeds": [
                {
                    "speed": entry.speed,
                    "setting": entry.setting,
                    "remark": entry.remark,
                    "modes": [self._mode(m, case, k) for k, m in enumerate(entry.modes)],
                }
                for entry, case in zip(self.speeds, self.table.cases, strict=True)
            ],
        }

    def _lines(self, entry: ModesAtSpeed, case: ModeCase) -> str:
        place = self.model
        if entry.speed or (self.has_speed and not entry.setting):
            place += f" at {shown(entry.speed, 'm/s')}"
        if entry.setting:
            place += f", {entry.setting}"
        head = [f"{place}: {', '.join(_counts(entry))}"]
        if entry.remark:
            head.append(entry.remark)
        rows = [self._line(m, case, k) for k, m in enumerate(entry.modes)]
        return "\n".join([*head, _HEAD, *rows])

    def _line(self, mode: Mode, case: ModeCase, number: int) -> str:
        value = mode.eigenvalue
        if mode.is_zero:
            return f"{_ZERO_WORDS[mode.kind]:>34} {'':>12} {'':>9}  {mode.dominant[0]}"
        words = self._shape(mode, case, number)
        if not mode.is_oscillation:
            return f"{f'{value.real:.6f}':>34} {'':>12} {'':>9}  {words}"
        pair = f"{round(value.real, 6) + 0.0:.6f} ± {value.imag:.6f}i"
        ratio = f"{round(mode.damping_ratio, 4) + 0.0:>9.4f}"
        return f"{pair:>34} {mode.frequency:>9.4f} Hz {ratio}  {words}"

    def _shape(self, mode: Mode, case: ModeCase, number: int) -> str:
        """Return the coordinates that take part most with amplitude and phase."""
        ranked = self.table.ranked(case, number)
        strong = [(name, value) for name, value, _ in ranked if abs(value) >= _SMALL][:_TOLD]
        if not strong:
            return ", ".join(mode.dominant[:_TOLD])
        return ", ".join(f"{name} {_polar(value)}" for name, value in strong)

    def _mode(self, mode: Mode, case: ModeCase, number: int) -> dict[str, Any]:
        units = {q.name: q.unit for q in self.table.channels}
        return {
            "real": mode.eigenvalue.real,
            "imaginary": mode.eigenvalue.imag,
            "kind": mode.kind,
            "is_pair": mode.is_oscillation,
            "frequency_hz": mode.frequency,
            "damping_ratio": mode.damping_ratio,
            "dominant_states": list(mode.dominant),
            "shape": [[float(v.real), float(v.imag)] for v in map(complex, mode.shape)],
            "participation": list(map(float, mode.participation)),
            "coordinates": [
                {
                    "name": name,
                    "unit": units[name],
                    "magnitude": abs(value),
                    "phase_deg": float(np.degrees(np.angle(value))) if value else 0.0,
                    "participation": share,
                }
                for name, value, share in self.table.ranked(case, number)
            ],
        }


def _polar(value: complex) -> str:
    size, phase = abs(value), float(np.degrees(np.angle(value)))
    if abs(phase) < 0.5:
        return f"{size:.3g}"
    if abs(abs(phase) - 180.0) < 0.5:
        return f"-{size:.3g}"
    return f"{size:.3g}∠{phase:.0f}°"


def _counts(entry: ModesAtSpeed) -> Iterator[str]:
    """Yield how many modes are zero, undamped and unstable, and whether all others decay."""
    moving = [m for m in entry.modes if abs(m.eigenvalue) >= NEAR_ZERO]
    undamped = sum(1 for m in moving if abs(m.eigenvalue.real) <= STABLE)
    yield f"{len(entry.modes) - len(moving)} zeros"
    if undamped:
        yield f"{undamped} undamped"
    if entry.unstable:
        yield f"{len(entry.unstable)} unstable"
    elif undamped < len(moving) or not undamped:
        yield "all others stable"
