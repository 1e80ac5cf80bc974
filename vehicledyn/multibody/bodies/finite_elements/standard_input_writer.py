"""Writes reduced bodies as files of standard input data, for this program and others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.finite_elements.reduced_modes import ReducedModes
from vehicledyn.multibody.bodies.finite_elements.standard_input_modes import standard_matrices

Array = NDArray[np.float64]
_GENERAL = 3


def write_standard_input(
    modes: ReducedModes, path: Path, nodes: Mapping[str, int] | None = None
) -> None:
    """Write a body with a node for each of its frames; reading it gives the same body.

    Parameters
    ----------
    modes
        The body, such as ``component_modes`` of a ``flexible_body``.
    path
        File to write.
    nodes
        Number of the node of each frame by name; 1, 2, ... without.
    """
    numbers = dict(nodes or {name: k for k, name in enumerate(modes.frames, 1)})
    path.write_text("\n".join([*_lines(modes, numbers), ""]), encoding="ascii", errors="replace")


def _lines(modes: ReducedModes, numbers: Mapping[str, int]) -> Iterator[str]:
    n = len(modes.frequencies)
    frames = ", ".join(f"{number} {name}" for name, number in numbers.items())
    yield f"{len(numbers):5d} {n:4d}    :No. nodes, No. modes: nodes {frames}; kg, m, s"
    yield " part"
    yield _entry(6, "new modal", "")
    yield f"{'':11}refmod"
    yield _entry(16, "mass", _number(modes.mass))
    yield _entry(16, "nelastq", str(n))
    for k, frequency in enumerate(modes.frequencies, 1):
        words = f"Mode {k:4d} : {frequency / (2.0 * np.pi):12.6g} Hz"
        yield _entry(16, f"ielastq ({k:4d})", words)
    yield f"{'':11}end refmod"
    yield f"{'':11}frame"
    for name, number in numbers.items():
        place, linear, turned = modes.frames[name]
        yield _entry(16, "new node", str(number))
        yield _entry(21, "rframe", "body ref")
        yield from _taylor(21, "origin", (place[:, None], linear[:, :, None]))
        yield from _taylor(21, "phi", (linear, modes.curved.get(name)), n)
        psi = np.zeros((3, n)) if turned is None else turned
        yield from _taylor(21, "psi", (psi, None), n)
        tilted = np.zeros((3, n, 3))
        for (i, j), (axis, sign) in _TILDE.items():
            tilted[i, :, j] = sign * psi[axis]
        yield from _taylor(21, "AP", (np.eye(3), tilted))
        yield f"{'':16}end node"
    yield f"{'':11}end frame"
    for name, values in standard_matrices(modes).items():
        yield from _taylor(11, name, values, n)
    yield f"{'':6}end modal"
    yield " end part"


_TILDE = {
    (2, 1): (0, 1.0), (1, 2): (0, -1.0), (0, 2): (1, 1.0), (2, 0): (1, -1.0), (1, 0): (2, 1.0),
    (0, 1): (2, -1.0),
}  # fmt: skip
"""Axis and sign of the entries of tilde(v)."""


def _taylor(
    indent: int, name: str, values: tuple[Array, Array | None], count: int = 0
) -> Iterator[str]:
    constant, linear = values
    n = linear.shape[1] if linear is not None else count
    is_zero = not constant.any() and (linear is None or not linear.any())
    yield f"{'':{indent}}{name}"
    order = int(linear is not None and bool(linear.any()))
    heads = {"order": order, "nrow": len(constant), "ncol": constant.shape[1], "nq": n, "nqn": 0}
    for key, value in (heads | {"structure": 0 if is_zero else _GENERAL}).items():
        yield _entry(26, key, str(value))
    for i, j in np.argwhere(constant):
        yield _entry(26, f"m0({i + 1:4d},{j + 1:4d})", _number(constant[i, j]))
    if order and linear is not None:
        for i, k, j in np.argwhere(linear):
            yield _entry(26, f"m1({i + 1:4d},{k + 1:4d},{j + 1:4d})", _number(linear[i, k, j]))
    yield f"{'':{indent}}end {name}"


def _entry(indent: int, key: str, value: str) -> str:
    return f"{'':{indent}}{key:<32}= {value}"


def _number(value: float) -> str:
    return f"{value:.17E}".replace("E", "D")
