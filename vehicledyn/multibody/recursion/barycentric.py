"""Barycentric parameters: what joints cannot feel of a body, moved to the body that carries it.

A mass on the axis of a turning joint moves alike whether it belongs to the body beyond the joint
or to the one before it, and a moment of inertia alike on either side of a sliding joint. Bodies
augmented by the masses beyond them (Samin, Fisette 2003, chapters 3.1.5 and 3.4; Wittenburg)
therefore have the same equations of motion with fewer parameters a body, and these are
combinations of parameters alone, which a kernel computes once for each set (Fisette, Raucent,
Samin 1996, Nonlinear Dynamics 9, 165-184).
"""

from __future__ import annotations

from vehicledyn.multibody.model.tree import Link, Tree, joint_rotation
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.multibody.recursion.flexible_inertia import FlexibleInertia
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar


def augmented_inertias(tree: Tree, base: int | None = None) -> list[BodyInertia]:
    """Return an inertia for each link that gives the forces on all coordinates.

    From the leaves to the root each link gives away all that its joint cannot feel:

    - a turning joint feels no mass on its axis and no transverse inertia of such a mass; what
      stays has mass zero, a first moment across the axis and five integrals of second degree;
    - a sliding joint feels no inertia matrix: mass and first moment stay;
    - a joint that turns and slides feels everything, a ball joint no mass at its centre;
    - a deformable body and what stands at its points keep everything;
    - a link without a joint keeps nothing, a body of revolution on its spin axis everything:
      its inertia is diagonal where it is.

    The forces along the coordinates and the mass matrix are those of the given bodies; the
    wrenches that the joints transmit and the energies of single bodies are not. What arrives
    at the ground is dropped.

    Parameters
    ----------
    tree
        Links, parents first.
    base
        A link that gives nothing away, as it moves freely; None if there is none.

    Returns
    -------
    list
        Inertia about each link's origin, in its axes, by index of the link.
    """
    own = [
        inertia.nothing() if item.flexibility else inertia.of_body(item.body) for item in tree.links
    ]
    for index in reversed(range(len(tree.links))):
        item = tree.links[index]
        if index == base or item.station is not None or item.flexibility is not None:
            continue
        own[index], given = _split(item, own[index])
        if item.parent >= 0:
            moved = given.in_parent([_fixed_rotation(item)], item.offset)
            own[item.parent] = own[item.parent] + moved
    return [
        moved if item.flexibility is None else FlexibleInertia(item.flexibility)
        for moved, item in zip(own, tree.links, strict=True)
    ]


def _split(item: Link, own: Inertia) -> tuple[Inertia, Inertia]:
    """Return what stays on a link and what is given away, both in the link's axes."""
    nothing = inertia.nothing()
    if item.type is None:
        return nothing, own
    if item.is_ignorable_spin:
        return own, nothing
    if item.slides_along is not None:
        return (
            Inertia(own.mass, own.moment, nothing.matrix),
            Inertia(nothing.mass, nothing.moment, own.matrix),
        )
    if item.turns_about is None and not item.type.elements:
        return own, nothing
    if item.turns_about is None or item.after is not None:
        # Oblique to the link's axes nothing but the mass vanishes from the recursions.
        return (
            Inertia(nothing.mass, own.moment, own.matrix),
            Inertia(own.mass, nothing.moment, nothing.matrix),
        )
    return _line_on_axis(own, item.turns_about - 1)


def _line_on_axis(own: Inertia, along: int) -> tuple[Inertia, Inertia]:
    """Split off masses on an axis with the mass, the place on it and the ∫ z² dm of the link."""
    first, second = (along + 1) % 3, (along + 2) % 3
    spread = own.spread()
    kept = {(i, j): own.matrix[i, j] for i, j in _PAIRS}
    kept[first, first], kept[second, second] = spread[second], spread[first]
    moment = [0.0 if k == along else own.moment[k] for k in range(3)]
    line = [own.moment[k] if k == along else 0.0 for k in range(3)]
    across = {(first, first): spread[along], (second, second): spread[along]}
    return (
        Inertia(ops.scalar(0.0), ops.vector(*moment), _with(kept), thin=along),
        Inertia(own.mass, ops.vector(*line), _with(across)),
    )


_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _with(elements: dict[tuple[int, int], Scalar]) -> Mat:
    """Return the symmetric matrix of some elements of the upper triangle, zero elsewhere."""
    values = [elements.get(pair, 0.0) for pair in _PAIRS]
    return rotations.symmetric(values[:3], values[3:])


def _fixed_rotation(item: Link) -> Mat:
    """Return the rotation to the parent of what is given away, which the joint does not turn."""
    return joint_rotation(item, 1.0, 0.0)
