"""What a deformable body moves by: modes, frames and inertia integrals, from whatever source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.finite_elements.geometric_stiffness import second_order
from vehicledyn.multibody.bodies.finite_elements.integrals import (
    InertiaIntegrals,
    inertia_integrals,
)
from vehicledyn.multibody.bodies.finite_elements.reduction import ComponentModes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ReducedModes:
    """Modes of a structure relative to its frame, with all that its motion depends on.

    Parameters
    ----------
    source
        What messages call it.
    frequencies
        Angular frequency of each mode, shape (n,) [rad/s].
    mass
        Mass of the body, the modal mass of each mode too [kg].
    damping
        Modal damping, shape (n, n) [N s/m].
    frames
        Place [m], displacement by and rotation by the amplitudes, (3, n) each, of each frame by
        name; no rotation where its node has none.
    integrals
        Inertia integrals about the frame of the body.
    curved
        Second derivatives Ψ of the place of a frame by the amplitudes, shape (3, n, n) [1/m], of
        those that geometric stiffening moves.
    """

    source: str
    frequencies: Array
    mass: float
    damping: Array
    frames: Mapping[str, tuple[Array, Array, Array | None]]
    integrals: InertiaIntegrals
    curved: Mapping[str, Array] = field(default_factory=dict)

    def lowest(self, count: int) -> ReducedModes:
        """Return the body with its slowest modes alone."""
        kept = slice(0, count)
        frames = {
            name: (at, linear[:, kept], None if turned is None else turned[:, kept])
            for name, (at, linear, turned) in self.frames.items()
        }
        curved = {name: value[:, kept, kept] for name, value in self.curved.items()}
        return ReducedModes(
            self.source,
            self.frequencies[kept],
            self.mass,
            self.damping[kept, kept],
            frames,
            self.integrals.lowest(count),
            curved,
        )


def reduced_modes(modes: ComponentModes) -> ReducedModes:
    """Return what the component modes of finite elements move by.

    Raises
    ------
    InputError
        If the geometric stiffness of the model lacks a load, or holds it elsewhere.
    """
    integrals = inertia_integrals(modes)
    curved: dict[str, Array] = {}
    if modes.model.geometric is not None:
        integrals, curved = second_order(modes, integrals)
    return ReducedModes(
        modes.model.source,
        modes.frequencies,
        modes.mass,
        modes.damping,
        modes.frames,
        integrals,
        curved,
    )
