"""Standard input data of a flexible body as modes and inertia integrals, and these as such data.

The matrices are the integrals of the body (Wallrapp 1994; Schwertassek, Wallrapp 1999, Dynamik
flexibler Mehrkörpersysteme, chapter 6): with p = x + Σ φ_k q_k + ½ Σ Ψ_kl q_k q_l

    Ct = ∫ ∂p/∂q dm,  Cr = ∫ p × ∂p/∂q dm,  Gr_k = -2 ∫ tilde(p) tilde(φ_k) dm,
    Ge_l = -2 ∫ φ_k × φ_l dm,  Oe ω_q = ∫ ∂p/∂q · ω × (ω × p) dm,
    ω_q = (ω_x², ω_y², ω_z², ω_x ω_y, ω_y ω_z, ω_x ω_z),  J = (xx, yy, zz, xy, xz, yz).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.integrals import (
    InertiaIntegrals,
    at_rest,
    beyond,
)
from vehicledyn.multibody.bodies.finite_elements.mode_signs import mode_signs
from vehicledyn.multibody.bodies.finite_elements.reduced_modes import ReducedModes
from vehicledyn.multibody.bodies.finite_elements.standard_input import StandardInput

Array = NDArray[np.float64]
PAIRS = ((0, 1), (1, 2), (0, 2))
"""Axes of the products of angular velocities in ω_q."""
_IN_J = ((0, 1), (0, 2), (1, 2))
_UNLIKE = 1e-6
_ROUNDING = 1e-10
"""Share of a matrix of twelve printed digits that is rounding."""


def modes_from(data: StandardInput, frames: Mapping[str, int]) -> ReducedModes:
    """Return the modes of a body, orthogonal and with its mass each, the slowest first.

    Parameters
    ----------
    data
        What the file holds.
    frames
        Node of each frame by name, one of the file.

    Raises
    ------
    InputError
        If matrices are asymmetric, indefinite or disagree, or the body is prestressed.
    """
    _refuse_contradictions(data)
    vectors, squares = _orthogonal(data)
    integrals, second = _integrals(data)
    if second is None and any(data.nodes[n]["phi"].linear.any() for n in frames.values()):
        second = np.zeros((data.count, data.count, 4, 3))
    turned, curved = {}, {}
    for name, number in frames.items():
        node = data.nodes[number]
        psi = node.get("psi")
        turn = None if psi is None else psi.constant @ vectors
        turned[name] = node["origin"].constant[:, 0], node["phi"].constant @ vectors, turn
        bent = np.einsum("alm,lk,mj->akj", node["phi"].linear, vectors, vectors)
        if second is not None:
            curved[name] = 0.5 * (bent + bent.transpose(0, 2, 1))
    damping = data.matrices.get("De")
    matrix = np.zeros_like(vectors) if damping is None else damping.constant
    return ReducedModes(
        data.source,
        np.sqrt(squares),
        data.mass,
        vectors.T @ matrix @ vectors,
        turned,
        _in_modes(integrals, second, vectors),
        curved,
    )


def _orthogonal(data: StandardInput) -> tuple[Array, Array]:
    """Return amplitudes of the file by those of the modes, and squared frequencies."""
    from scipy.linalg import LinAlgError, eigh

    for name in ("Me", "Ke", "De"):
        if name in data.matrices:
            _refuse_asymmetric(data, name)
    mass, stiffness = (_symmetric(data.matrices[name].constant) for name in ("Me", "Ke"))
    try:
        np.linalg.cholesky(mass)
        squares, vectors = eigh(stiffness, mass)
    except (np.linalg.LinAlgError, LinAlgError):
        raise InputError(
            f"{data.where('Me')}: Me: is indefinite; no motion may have negative energy"
        ) from None
    if squares[0] <= _ROUNDING * squares[-1]:
        raise InputError(
            f"{data.where('Ke')}: Ke: is indefinite or lets a mode move freely; take rigid "
            "motions out of the modes, and check signs"
        )
    damping = data.matrices.get("De")
    if damping is not None and damping.constant.any():
        lowest = np.linalg.eigvalsh(_symmetric(damping.constant))
        if lowest[0] < -_UNLIKE * lowest[-1]:
            raise InputError(f"{data.where('De')}: De: is indefinite; damping takes energy away")
    return np.asarray(vectors * mode_signs(vectors) * np.sqrt(data.mass)), np.asarray(squares)


def _integrals(data: StandardInput) -> tuple[InertiaIntegrals, Array | None]:
    """Return the integrals by the amplitudes of the file, and those of second order."""
    m, n = data.matrices, data.count
    inertia = tensor(m["J"].constant[:, 0])
    products = np.zeros((4 + 3 * n,) * 2)
    products[0, 0] = data.mass
    products[0, 1:4] = m["mdCM"].constant[:, 0]
    products[0, 4:] = m["Ct"].constant.ravel()
    products[1:4, 1:4] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    for k in range(n):
        products[1:4, 4 + 3 * k : 7 + 3 * k] = _first_order(data, k)
    pairs, second = _second_order(data)
    products[4:, 4:] = pairs.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
    products = np.triu(products) + np.triu(products, 1).T
    exact = np.block([[inertia, m["Cr"].constant.T], [m["Cr"].constant, m["Me"].constant]])
    whole = np.zeros((6 + n, 6 + n))
    whole[:3, :3] = data.mass * np.eye(3)
    whole[3:, 3:] = exact
    x, y, z = m["mdCM"].constant[:, 0]
    whole[:3, 3:6] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    whole[:3, 6:] = m["Ct"].constant.T
    whole = np.triu(whole) + np.triu(whole, 1).T
    sizes = np.sqrt(np.abs(np.diag(whole)))
    sizes[sizes == 0.0] = 1.0
    lowest = np.linalg.eigvalsh(whole / np.outer(sizes, sizes))[0]
    if lowest < -_UNLIKE:
        raise InputError(
            f"{data.where('J')}: J, Cr, Ct, mdCM and Me are together indefinite; no motion may "
            "have negative energy: are all of one body, about one origin, in kg, m and s?"
        )
    return InertiaIntegrals(products, beyond(exact, products)), second


def _first_order(data: StandardInput, k: int) -> Array:
    """Return ∫ x φ_kᵀ dm: from Gr, or where that is empty its halves from Oe and Cr."""
    own = data.matrices["Gr"].constant[:, 3 * k : 3 * k + 3]
    if data.matrices["Gr"].constant.any():
        return np.asarray(-0.5 * own.T + 0.25 * np.trace(own) * np.eye(3))
    return _from_squares(data.matrices["Oe"].constant[k]) + 0.5 * _cross_parts(
        data.matrices["Cr"].constant[k]
    )


def _second_order(data: StandardInput) -> tuple[Array, Array | None]:
    """Return ∫ φ_k φ_lᵀ dm, shape (n, n, 3, 3), and the integrals of the Ψ_kl."""
    m, n = data.matrices, data.count
    # Oe and Cr hold φ_l φ_kᵀ + x Ψ_klᵀ, whose parts with x are symmetric in k and l.
    both = np.array([[_from_squares(m["Oe"].linear[k, j]) for j in range(n)] for k in range(n)])
    turned, skewed = m["Cr"].linear, np.zeros((n, n, 3))
    if "Ge" in m and m["Ge"].constant.any():
        skewed = -0.5 * m["Ge"].constant.reshape(n, n, 3)
        turned = turned if turned.any() else -skewed
    else:
        skewed = 0.5 * (turned.transpose(1, 0, 2) - turned)
    whole = both + 0.5 * np.apply_along_axis(_cross_parts, 2, turned)
    moved = m["Ct"].linear
    wound = 0.5 * (turned + turned.transpose(1, 0, 2))
    size = np.abs(both).max(initial=1e-300)
    is_stiffened = bool(moved.any() or np.abs(wound).max(initial=0.0) > _ROUNDING * size)
    if m["Gr"].linear.any():
        pairs = np.zeros((n, n, 3, 3))
        for k in range(n):
            for j in range(n):
                own = m["Gr"].linear[:, k, 3 * j : 3 * j + 3]
                # -2 ∫ tilde(φ_k) tilde(φ_j) dm = -2 (∫ φ_j φ_kᵀ dm - tr 1)
                pairs[k, j] = (-0.5 * own + 0.25 * np.trace(own) * np.eye(3)).T
    else:
        # The trace of ∫ φ φᵀ is the modal mass; what remains is the stiffening's.
        pairs = both + 0.5 * np.apply_along_axis(_cross_parts, 2, skewed)
        if is_stiffened:
            excess = np.trace(both, axis1=2, axis2=3) - m["Me"].constant
            pairs = pairs - excess[:, :, None, None] / 3.0 * np.eye(3)
    rest = whole - pairs.transpose(1, 0, 2, 3)
    if not is_stiffened and np.abs(rest).max(initial=0.0) <= _ROUNDING * size:
        return pairs, None
    rest = 0.5 * (rest + rest.transpose(1, 0, 2, 3))
    moved = 0.5 * (moved + moved.transpose(1, 0, 2))
    return pairs, np.concatenate([moved[:, :, None, :], rest], axis=2)


def _in_modes(
    integrals: InertiaIntegrals, second: Array | None, vectors: Array
) -> InertiaIntegrals:
    """Return integrals by other amplitudes, q = ``vectors`` times these."""
    n = len(vectors)
    wide = np.zeros((4 + 3 * n,) * 2)
    wide[:4, :4] = np.eye(4)
    wide[4:, 4:] = np.kron(vectors, np.eye(3))
    turn = np.eye(3 + n)
    turn[3:, 3:] = vectors
    bent = None if second is None else np.einsum("lmfa,lk,mj->kjfa", second, vectors, vectors)
    return InertiaIntegrals(
        wide.T @ integrals.products @ wide, turn.T @ integrals.turning @ turn, bent
    )


def standard_matrices(modes: ReducedModes) -> dict[str, tuple[Array, Array | None]]:
    """Return the matrices of a body by name, their constant and linear parts."""
    found, n = modes.integrals, len(modes.frequencies)
    products, second = found.products, found.second
    exact = at_rest(products) + found.turning
    first = [products[1:4, 4 + 3 * k : 7 + 3 * k] for k in range(n)]
    pairs = products[4:, 4:].reshape(n, 3, n, 3).transpose(0, 2, 1, 3)
    moved = np.zeros((n, n, 3)) if second is None else second[:, :, 0]
    whole = pairs.transpose(1, 0, 2, 3) + (0.0 if second is None else second[:, :, 1:])
    inertia = [tensor_rows(_about(part + part.T)) for part in first]
    gyroscopic = np.hstack([-2.0 * (part.T - np.trace(part) * np.eye(3)) for part in first])
    further = np.zeros((3, n, 3 * n))
    for k in range(n):
        for j in range(n):
            own = pairs[k, j].T - np.trace(pairs[k, j]) * np.eye(3)
            further[:, k, 3 * j : 3 * j + 3] = -2.0 * own
    crossed = np.array([[_axial(pairs[k, j]) for j in range(n)] for k in range(n)])
    squares = np.array([[_squares(whole[k, j]) for j in range(n)] for k in range(n)])
    stiffness = np.diag(modes.mass * modes.frequencies**2)
    return {
        "mdCM": (products[0, 1:4, None], products[0, 4:].reshape(n, 3).T[:, :, None]),
        "J": (tensor_rows(exact[:3, :3])[:, None], np.array(inertia).T[:, :, None]),
        "Ct": (products[0, 4:].reshape(n, 3), moved),
        "Cr": (
            exact[3:, :3],
            np.array([[_axial(whole[k, j]) for j in range(n)] for k in range(n)]),
        ),
        "Me": (exact[3:, 3:], None),
        "Gr": (gyroscopic, further),
        "Ge": (-2.0 * crossed.reshape(n, 3 * n), None),
        "Oe": (np.array([_squares(part) for part in first]), squares),
        "ksigma": (np.zeros((n, 1)), None),
        "Ke": (stiffness, None),
        "De": (modes.damping, None),
    }


def _refuse_contradictions(data: StandardInput) -> None:
    m = data.matrices
    stress = m.get("ksigma")
    if stress is not None and stress.constant.any():
        raise InputError(
            f"{data.where('ksigma')}: ksigma: the body is prestressed, which is not read; write "
            "the data about its state at rest"
        )
    linear = m["mdCM"].linear[:, :, 0].T
    _refuse_unlike(data, ("mdCM", "Ct"), (linear, m["Ct"].constant))
    gyroscopic = m["Gr"].constant
    if gyroscopic.any():
        first = [_squares(_first_order(data, k)) for k in range(data.count)]
        _refuse_unlike(data, ("Oe", "Gr"), (m["Oe"].constant, np.array(first)))


def _refuse_unlike(
    data: StandardInput, names: tuple[str, str], values: tuple[Array, Array]
) -> None:
    size = np.abs(values[1]).max(initial=0.0)
    away = np.abs(values[0] - values[1])
    if values[0].any() and away.max(initial=0.0) > _UNLIKE * size:
        k = int(np.argmax(away.max(axis=1)))
        raise InputError(
            f"{data.where(names[0])}: {names[0]}: does not go with {names[1]} of line "
            f"{data.matrices[names[1]].line} in mode {k + 1}; both are of the same integrals"
        )


def _refuse_asymmetric(data: StandardInput, name: str) -> None:
    values = data.matrices[name].constant
    away = np.abs(values - values.T)
    if away.max(initial=0.0) > _UNLIKE * np.abs(values).max(initial=0.0):
        i, j = sorted(int(k) for k in np.unravel_index(int(np.argmax(away)), away.shape))
        raise InputError(
            f"{data.where(name)}: {name}: is not symmetric: entry ({i + 1}, {j + 1}) is "
            f"{values[i, j]:.6g} and ({j + 1}, {i + 1}) is {values[j, i]:.6g}"
        )


def _symmetric(values: Array) -> Array:
    return np.asarray(0.5 * (values + values.T))


def tensor(values: Array) -> Array:
    """Return the inertia tensor of the six numbers of J."""
    found = np.diag(values[:3])
    for (i, j), value in zip(_IN_J, values[3:], strict=True):
        found[i, j] = found[j, i] = value
    return found


def tensor_rows(matrix: Array) -> Array:
    """Return the six numbers of J of a tensor."""
    return np.array([*np.diag(matrix), *(matrix[pair] for pair in _IN_J)])


def _about(second: Array) -> Array:
    """Return the inertia tensor of ∫ x xᵀ dm."""
    return np.asarray(np.trace(second) * np.eye(3) - second)


def _axial(block: Array) -> Array:
    """Return ∫ f × g dm of ∫ f gᵀ dm."""
    return np.array(
        [block[1, 2] - block[2, 1], block[2, 0] - block[0, 2], block[0, 1] - block[1, 0]]
    )


def _cross_parts(vector: Array) -> Array:
    """Return the matrix A - Aᵀ whose axial vector is given."""
    x, y, z = vector
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def _squares(block: Array) -> Array:
    """Return the six factors of ω_q in ω × (ω × f) · g, from ∫ f gᵀ dm."""
    diagonal = np.diag(block) - np.trace(block)
    return np.array([*diagonal, *(block[i, j] + block[j, i] for i, j in PAIRS)])


def _from_squares(values: Array) -> Array:
    """Return the symmetric half of ∫ f gᵀ dm from these factors."""
    found = np.diag(values[:3] - 0.5 * values[:3].sum())
    for (i, j), value in zip(PAIRS, values[3:], strict=True):
        found[i, j] = found[j, i] = 0.5 * value
    return found
