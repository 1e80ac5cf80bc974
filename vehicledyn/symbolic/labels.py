"""Give vectors and rotations the labels of their axes, see ``frames``."""

from __future__ import annotations

from vehicledyn.symbolic.ops import Mat, Vec


def in_axes(vector: Vec, axes: str) -> Vec:
    """Return the same vector, labelled with the axes it is expressed in."""
    from vehicledyn.symbolic.labelled import LabelledVector

    return LabelledVector(vector, axes)


def turning(rotation: Mat, *, to: str, of: str) -> Mat:
    """Return the same R with v_to = R v_of, labelled with both axes."""
    from vehicledyn.symbolic.labelled import LabelledRotation

    return LabelledRotation(rotation, to, of)


def unlabelled(matrix: Mat | Vec) -> Mat | Vec:
    """Return the same vector or rotation without a label, for frames that are to coincide."""
    import casadi

    return casadi.SX(matrix)
