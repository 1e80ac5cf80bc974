"""Watch beams of assumed modes, which hold for small deflections, for large ones."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import ops

Matrix = NDArray[np.float64]

LARGE = 0.25
"""Deflection of the end over the length beyond which modes are more than 0.1 % off [1].

Against a geometrically exact beam at rest 0.05 % at 0.26, 0.6 % at 0.41; in a spin-up 0.06 % at
0.25, 0.5 % at 0.36.
"""

_END = ".tip_y"


@dataclass
class _Watched:
    """A beam, the columns of the deflections of its end, and the largest over its length."""

    name: str
    columns: tuple[int, int]
    length: float
    largest: float = 0.0
    time: float = 0.0


@dataclass
class BentBeams:
    """Watches the ends of beams in samples as they come; :meth:`remarks` says which bent far."""

    watched: list[_Watched] = field(default_factory=list)

    @staticmethod
    def of(prepared: Prepared) -> BentBeams:
        """Return a watch on the beams of a system by assumed modes of small deflections."""
        names = [channel.name for channel in prepared.equations.channels]
        if not any(name.endswith(_END) for name in names):
            return BentBeams()
        system, parameters = prepared.subject.system, prepared.kernel.parameters
        found = []
        for name, length in _lengths(system, parameters).items():
            columns = (names.index(f"{name}{_END}"), names.index(f"{name}.tip_z"))
            found.append(_Watched(name, columns, length))
        return BentBeams(found)

    def take(self, times: Matrix, outputs: Matrix) -> None:
        """Look at samples, shapes (n,) and (n, n_channels)."""
        if not len(times):
            return
        for beam in self.watched:
            shares = np.hypot(*outputs[:, beam.columns].T) / beam.length
            k = int(np.argmax(shares))
            if shares[k] > beam.largest:
                beam.largest, beam.time = float(shares[k]), float(times[k])

    def remarks(self) -> list[str]:
        """Return a warning for each beam whose end moved far."""
        return [
            f"warning: beam '{beam.name}': its end moves aside by {beam.largest:.2g} of its length "
            f"at t = {beam.time:.6g} s; 'model: modes' is 0.1 % off beyond {LARGE:g} and "
            "soon some per cent: take 'model: exact' or 'model: segments'"
            for beam in self.watched
            if beam.largest > LARGE
        ]


def _lengths(system: System, parameters: Matrix) -> dict[str, float]:
    """Return the lengths of the beams by assumed modes of small deflections by name [m]."""
    from vehicledyn.multibody.elements.flexible.beam import Beam

    beams = [part for part in system.parts if isinstance(part, Beam) and part.model == "modes"]
    if not beams:
        return {}
    symbols = ops.column([entry.symbol for entry in system.table.entries])
    values = ops.numeric([symbols], ops.column([beam.length for beam in beams]))(parameters)
    return {beam.name: float(value) for beam, value in zip(beams, values[:, 0], strict=True)}
