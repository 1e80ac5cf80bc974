"""Results of a kinematic sweep as a table and as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.mechanism_path import Finding
from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]
SHOWN = {"m": ("mm", 1e3), "rad": ("deg", 180.0 / np.pi)}
"""Units that people read instead of SI, with factors."""


@dataclass(frozen=True)
class KinematicsReport:
    """Results of a kinematic sweep.

    ``table`` holds the channels, shape (n_samples, n_channels), in SI.
    """

    model: str
    path: Path
    status: str
    held: tuple[str, ...]
    channels: tuple[Channel, ...]
    table: Array
    shown: tuple[int, ...]
    singular: tuple[Finding, ...]
    failures: tuple[Finding, ...]
    messages: list[str] = field(default_factory=list)

    def as_text(self) -> str:
        """Return a table of the drives and some channels, after what a person must know."""
        lines = [f"{self.path}: {self.status}, {len(self.table)} places"]
        if self.held:
            lines.append(f"held: {', '.join(self.held)}")
        lines += [f.words for f in self.singular]
        units = [SHOWN.get(self.channels[k].unit, (self.channels[k].unit, 1.0)) for k in self.shown]
        heads = [
            f"{self.channels[k].name} [{u}]" for k, (u, _) in zip(self.shown, units, strict=True)
        ]
        widths = [max(len(head), 14) for head in heads]
        lines += ["", "  ".join(f"{h:>{w}}" for h, w in zip(heads, widths, strict=True))]
        for row in self.table:
            cells = (row[k] * factor for k, (_, factor) in zip(self.shown, units, strict=True))
            texts = (f"{_clean(c):>{w}.6f}" for c, w in zip(cells, widths, strict=True))
            lines.append("  ".join(texts))
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, channels in SI."""
        return {
            "model": self.model,
            "result": self.path,
            "status": self.status,
            "held": list(self.held),
            "singular": [_finding(f) for f in self.singular],
            "failures": [_finding(f) for f in self.failures],
            "channels": {
                c.name: {"unit": c.unit, "description": c.description, "values": self.table[:, k]}
                for k, c in enumerate(self.channels)
            },
        }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "drives": list(finding.drives),
        "coordinates": list(finding.coordinates),
        "text": finding.words,
    }


def _clean(value: float) -> float:
    return 0.0 if abs(value) < 5e-10 else value
