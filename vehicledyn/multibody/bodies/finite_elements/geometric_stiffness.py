"""Geometric stiffening: how axial forces stiffen a body, as displacements of second order.

The stiffness K that a load f gives a structure by the stresses it causes is what f would do at
displacements of second order in the amplitudes, ½ q_k q_l Ψ_kl: K_kl = -∫ f·Ψ_kl. So matrices of
unit loads give the Ψ of loaded nodes and the integrals ∫ Ψ dm and ∫ x Ψᵀ dm. Beams shorten as they
bend; here it is whatever the structure does (Wallrapp, Schwertassek 1991, Int. J. Num. Meth. Eng.
32, 1833-1850).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.integrals import InertiaIntegrals
from vehicledyn.multibody.bodies.finite_elements.reduction import PIECE, ComponentModes

Array = NDArray[np.float64]
_AXES = "xyz"


def second_order(
    modes: ComponentModes, integrals: InertiaIntegrals
) -> tuple[InertiaIntegrals, dict[str, Array]]:
    """Return the integrals with those of the Ψ, and the Ψ of frames by name, (3, n, n) each.

    Raises
    ------
    InputError
        If a load is missing, or the structure was held elsewhere while it was loaded.
    """
    model, given = modes.model, modes.model.geometric
    if given is None:
        raise ValueError(f"{model.source} has no geometric stiffness")
    held = modes.held_node
    if given.held != held:
        known = {0: "by its inertia", PIECE: "at several nodes"}
        words = [known.get(n, f"at node {n}") for n in (given.held, held)]
        raise InputError(
            f"reference: {model.source}: its geometric stiffness is that of the structure held "
            f"{words[0]}, the body is held {words[1]}; compute it again, or use this reference"
        )

    def of(load: str) -> Array:
        if load not in given.matrices:
            raise InputError(
                f"{model.source}: geometric stiffness lacks the load '{load}'; give those of the "
                "three accelerations, of the nine inertia forces and of forces on each interface "
                "and named node"
            )
        return np.asarray(modes.shapes.T @ (given.matrices[load] @ modes.shapes))

    moved = np.stack([of(f"acceleration_{axis}") for axis in _AXES], axis=-1)
    about = [[of(f"inertia_{along}_{axis}") for axis in _AXES] for along in _AXES]
    moments = np.moveaxis(np.array(about), (0, 1), (2, 3))
    moments = moments - modes.origin[:, None] * moved[:, :, None, :]
    second = np.concatenate([moved[:, :, None, :], moments], axis=2)
    curved = {}
    for name, node in modes.nodes.items():
        if node == PIECE:
            raise InputError(
                f"interface.{name}: is a piece of several nodes, whose geometric stiffness is not "
                "known; name one node, and join the others to it in the matrices"
            )
        is_named = f"force_{node}_x" in given.matrices or not name.startswith("node_")
        if is_named and node != held:
            curved[name] = -np.array([of(f"force_{node}_{axis}") for axis in _AXES])
    return replace(integrals, second=second), curved
