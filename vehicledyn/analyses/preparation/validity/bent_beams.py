"""Watch beams of assumed modes, which hold for moderate deflections, for large ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic import ops

Matrix = NDArray[np.float64]

LARGE = 0.25
"""Deflection of the end over the length beyond which modes are more than 0.1 % off [1].

Against a geometrically exact beam at rest 0.05 % at 0.26, 0.6 % at 0.41; in a spin-up 0.06 % at
0.25, 0.5 % at 0.36.
"""

_END = ".tip_y"


@dataclass(frozen=True)
class MonitoredBeams:
    """Beams by assumed modes of moderate deflections.

    ``columns`` are those of the deflections of their ends among the channels, along y and z;
    ``lengths`` takes the parameters and returns the lengths [m].
    """

    names: Sequence[str] = ()
    columns: Sequence[tuple[int, int]] = ()
    lengths: Callable[[Matrix], Matrix] = np.asarray

    @staticmethod
    def of(prepared: Prepared) -> MonitoredBeams:
        """Return those of a system."""
        channels = [channel.name for channel in prepared.equations.channels]
        if not any(name.endswith(_END) for name in channels):
            return MonitoredBeams()
        from vehicledyn.multibody.elements.flexible.beam import Beam

        system = prepared.subject.system
        beams = [part for part in system.parts if isinstance(part, Beam) and part.model == "modes"]
        if not beams:
            return MonitoredBeams()
        symbols = ops.column([entry.symbol for entry in system.table.entries])
        values = ops.numeric([symbols], ops.column([beam.length for beam in beams]))
        names = [beam.name for beam in beams]
        columns = [(channels.index(f"{n}{_END}"), channels.index(f"{n}.tip_z")) for n in names]
        return MonitoredBeams(names, columns, lambda parameters: values(parameters)[:, 0])

    def bends(self, channel: Callable[[int], Matrix], parameters: Matrix) -> dict[str, Matrix]:
        """Return how far the ends move aside over the lengths, from the channels by number."""
        if not self.names:
            return {}
        lengths = self.lengths(parameters)
        return {
            name: np.asarray(np.hypot(channel(y), channel(z)) / length)
            for name, (y, z), length in zip(self.names, self.columns, lengths, strict=True)
        }


@dataclass
class BentBeams:
    """Watches the ends of beams in samples as they come; :meth:`remarks` says which bent far."""

    watched: MonitoredBeams
    parameters: Matrix
    _largest: dict[str, tuple[float, float]] = field(default_factory=dict)

    @staticmethod
    def of(prepared: Prepared) -> BentBeams:
        """Return a watch on the beams of a system."""
        return BentBeams(MonitoredBeams.of(prepared), prepared.kernel.parameters)

    def take(self, times: Matrix, outputs: Matrix) -> None:
        """Look at samples, shapes (n,) and (n, n_channels)."""
        if not len(times):
            return
        bends = self.watched.bends(lambda k: outputs[:, k], self.parameters)
        for name, values in bends.items():
            k = int(np.argmax(values))
            if values[k] > self._largest.get(name, (0.0, 0.0))[0]:
                self._largest[name] = float(values[k]), float(times[k])

    def remarks(self) -> list[str]:
        """Return a warning for each beam whose end moved far."""
        return [
            bent_far(name, f"by {bend:.2g} of its length at t = {time:.6g} s")
            for name, (bend, time) in self._largest.items()
            if bend > LARGE
        ]


def bent_far(name: str, how: str) -> str:
    """Return a warning of a beam whose end moves aside so."""
    return (
        f"warning: beam '{name}': its end moves aside {how}; 'model: modes' is 0.1 % off beyond "
        f"{LARGE:g} and soon some per cent: take 'model: exact' or 'model: segments'"
    )


def bent_at(prepared: Prepared, point: AssembledPoint) -> list[str]:
    """Return a warning for each beam that is bent far at a point."""
    return bent_among(prepared, [("", prepared.kernel, point)])


def bent_among(
    prepared: Prepared, points: Iterable[tuple[str, Kernel, AssembledPoint]]
) -> list[str]:
    """Return a warning for each beam that is bent far at one of several points.

    Each has words for the place, such as "at speed = 3 m/s", and its own kernel.
    """
    watched = MonitoredBeams.of(prepared)
    if not watched.names:
        return []
    time, largest = prepared.subject.balance_time, dict[str, tuple[float, str]]()
    for where, kernel, point in points:
        outputs = np.asarray(kernel.outputs(time, point.state, point.unknowns))
        for name, bend in watched.bends(outputs.__getitem__, kernel.parameters).items():
            if bend > max(LARGE, largest.get(name, (0.0, ""))[0]):
                largest[name] = float(bend), where
    return [
        bent_far(name, f"by {bend:.2g} of its length{where and ' '}{where}")
        for name, (bend, where) in largest.items()
    ]
