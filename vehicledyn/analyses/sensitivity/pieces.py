"""The pieces of a motion between changes of its dependent coordinates, ready for tangents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.analyse.gradients.motion_stretches import PartitionPiece
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import TangentCode
from vehicledyn.symbolic.equations import Equations


@dataclass
class Pieces:
    """Compiled tangents of the partitions that motions take, kept for later ones."""

    codes: dict[tuple[int, tuple[str, ...]], tuple[Equations, TangentCode]] = field(
        default_factory=dict
    )

    def of(
        self,
        begin: PartitionPiece,
        changes: Sequence[tuple[float, Kernel]],
        channels: Sequence[str],
    ) -> tuple[PartitionPiece, ...]:
        """Return the pieces of a motion that observe channels, the first one first.

        Parameters
        ----------
        begin
            The first piece, whose code observes the channels.
        changes
            Times [s] and kernels of the later ones.
        channels
            Names of the channels wanted.

        Raises
        ------
        NumericalError
            If a later partition lacks a channel or state.
        """
        kernels = [begin.kernel, *(kernel for _, kernel in changes)]
        times = [begin.time, *(time for time, _ in changes)]
        found = []
        for k, (time, kernel) in enumerate(zip(times, kernels, strict=True)):
            after = kernels[k + 1] if k + 1 < len(kernels) else None
            names = [*channels, *([] if after is None else _missing(kernel, after))]
            if k == 0 and len(names) == len(channels):
                found.append(begin)
            else:
                found.append(PartitionPiece(time, kernel, self._code(kernel.equations, names)))
        return tuple(found)

    def _code(self, equations: Equations, names: Sequence[str]) -> TangentCode:
        key = (id(equations), tuple(names))
        if key not in self.codes:
            places = {c.name: place for place, c in enumerate(equations.channels)}
            lost = [name for name in names if name not in places]
            if lost:
                raise NumericalError(
                    f"'{lost[0]}' is no channel with the dependent coordinates that the run "
                    "changes to; derivatives end there"
                )
            code = TangentCode(equations, [places[name] for name in names])
            self.codes[key] = equations, code
        return self.codes[key][1]


def _missing(before: Kernel, after: Kernel) -> list[str]:
    """Return the states behind a change that are only channels before it."""
    e = before.equations
    known = {item.name for item in (*e.states, *e.unknowns)}
    return [item.name for item in after.equations.states if item.name not in known]
