"""Reduction of finite elements: frequencies, static deflections and inertia integrals."""

import numpy as np
import pytest
from finite_elements import assembled, lattice, straight
from scipy.linalg import eigh

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements import reduction
from vehicledyn.multibody.bodies.finite_elements.integrals import inertia_integrals
from vehicledyn.multibody.bodies.finite_elements.interfaces import joined
from vehicledyn.multibody.bodies.finite_elements.model import rigid_motions
from vehicledyn.multibody.bodies.finite_elements.reduction import component_modes

LENGTH, BENDING, MASS = 1.5, 50.0, 2.0
GIVEN = {
    "axial": 5e5, "torsion": 20.0, "bending": (BENDING, 1.7 * BENDING), "mass": MASS, "polar": 0.01,
}  # fmt: skip
CLAMPED = (1.8751040687119611, 4.694091132974174, 7.854757438237612)
FREE = (4.730040744862704, 7.853204624095838)
PLACES = [(0, 0, 0), (0.5, 0, 0.1), (1, 0.1, 0), (1.5, 0, 0), (1, 0.6, 0)]
MEMBERS = [(0, 1), (1, 2), (2, 3), (2, 4)]
FRAME = {"root": 1, "tip": 4, "side": 5}


@pytest.fixture(scope="module")
def frame():
    return assembled(PLACES, MEMBERS, GIVEN)


def frequency(root):
    return (root / LENGTH) ** 2 * np.sqrt(BENDING / MASS)


def test_clamped_beam():
    """A cantilever with its exact modes: bending, torsion and extension of the closed forms."""
    found = component_modes(
        straight(LENGTH, 20, GIVEN), {"start": 1}, 12, reference="start", kept={"tip": 21}
    ).frequencies
    wanted = [frequency(root) * f for root in CLAMPED[:2] for f in (1.0, np.sqrt(1.7))]
    wanted.append(frequency(CLAMPED[2]))
    for value in wanted:
        assert np.abs(found / value - 1.0).min() < 1e-4


def test_free_beam_by_its_ends():
    """With both ends as interfaces few normal modes give the modes of the free beam."""
    stiff = GIVEN | {"torsion": 2e4, "axial": 5e7}
    found = component_modes(straight(LENGTH, 24, stiff), {"start": 1, "tip": 25}, 20).frequencies
    for root in FREE:
        assert np.abs(found / frequency(root) - 1.0).min() < 1e-4


def test_more_modes_come_closer(frame):
    """The reduced frequencies are bounds from above and those of the matrices with all modes."""
    mass, stiffness = frame.mass.toarray(), frame.stiffness.toarray()
    exact = np.sqrt(eigh(stiffness, mass, eigvals_only=True)[6:])
    few, all_of_them = (component_modes(frame, FRAME, n).frequencies for n in (3, 12))
    assert (few >= exact[: len(few)] * (1.0 - 1e-9)).all()
    assert all_of_them == pytest.approx(exact, rel=1e-8)


def test_large_models_have_the_same_modes(monkeypatch):
    """Modes by Lanczos' method on sparse matrices are those of the full ones."""
    beam, ends = straight(LENGTH, 12, GIVEN), {"start": 1, "tip": 13}
    full = component_modes(beam, ends, 5).frequencies
    monkeypatch.setattr(reduction, "_DENSE", 0)
    assert component_modes(beam, ends, 5).frequencies == pytest.approx(full, rel=1e-8)


def test_damping_of_the_matrix(frame):
    """A damping matrix in proportion to mass and stiffness damps each mode by itself."""
    import dataclasses

    damping = 0.3 * frame.mass + 2e-4 * frame.stiffness
    made = component_modes(dataclasses.replace(frame, damping=damping), FRAME, 3)
    wanted = made.mass * (0.3 + 2e-4 * made.frequencies**2)
    size = np.abs(wanted).max()
    assert made.damping == pytest.approx(np.diag(wanted), abs=1e-9 * size)


@pytest.mark.parametrize("modes", [0, 4])
def test_loads_on_interfaces_deflect_exactly(frame, modes):
    """Static deflections under forces and moments on interfaces are those of the matrices."""
    made = component_modes(frame, FRAME, modes, reference="root", kept={"middle": 3})
    load = np.array([3.0, 1.0, 2.0, 0.1, 0.2, 0.3])
    right = np.zeros(30)
    right[18:24] = load
    exact = np.zeros(30)
    exact[6:] = np.linalg.solve(frame.stiffness.toarray()[6:, 6:], right[6:])
    tip = np.vstack(made.frames["tip"][1:])
    q = tip.T @ load / (made.mass * made.frequencies**2)
    size = np.abs(exact).max()
    for name, node in (("tip", 4), ("side", 5), ("middle", 3)):
        moved = np.vstack(made.frames[name][1:]) @ q
        assert moved == pytest.approx(exact[6 * node - 6 : 6 * node], abs=1e-9 * size)


def test_rigid_pieces_of_a_solid():
    """Faces of a block of nodes without rotations move and turn as pieces, deflecting exactly."""
    block = lattice((5, 2, 2), 0.1)
    faces = {"left": [1, 2, 3, 4], "right": [17, 18, 19, 20]}
    made = component_modes(block, faces, 2, reference="left")
    whole = joined(block, faces)
    stiffness = (whole.join.T @ block.stiffness @ whole.join).toarray()
    free = np.setdiff1d(np.arange(len(stiffness)), whole.interfaces["left"].columns)
    load = np.array([3.0, 1.0, 2.0, 0.1, 0.2, 0.3])
    right = np.zeros(len(stiffness))
    right[whole.interfaces["right"].columns] = load
    exact = np.zeros(len(stiffness))
    exact[free] = np.linalg.solve(stiffness[np.ix_(free, free)], right[free])
    face = np.vstack(made.frames["right"][1:])
    q = face.T @ load / (made.mass * made.frequencies**2)
    assert face @ q == pytest.approx(exact[whole.interfaces["right"].columns], rel=1e-9)
    assert made.frames["right"][0] == pytest.approx([0.4, 0.0, 0.0])


def test_forces_alone_take_half_the_coordinates(frame):
    """Interfaces without moments have three static shapes each and deflect under forces exactly."""
    made = component_modes(frame, FRAME, 1, motion="translations")
    assert len(made.frequencies) == 3 * 3 - 6 + 1
    forces = np.zeros(30)  # In balance: along the line from tip to side.
    along = np.subtract(PLACES[3], PLACES[4])
    forces[18:21], forces[24:27] = along, -along
    exact = np.linalg.lstsq(frame.stiffness.toarray(), forces, rcond=None)[0]
    moved = made.frames["tip"][1], made.frames["side"][1]
    q = (moved[0] - moved[1]).T @ along / (made.mass * made.frequencies**2)
    assert forces @ exact == pytest.approx(along @ (moved[0] - moved[1]) @ q, rel=1e-9)


def test_modes_above_a_frequency_are_left_out(frame):
    made = component_modes(frame, FRAME, 3)
    limit = made.frequencies[4] * 1.001
    assert component_modes(frame, FRAME, 3, highest=limit).frequencies == pytest.approx(
        made.frequencies[:5]
    )


def energy_of(made, spin, rates, velocity):
    """Return the kinetic energy of a structure without deformation, from its mass matrix."""
    model = made.model
    nodes = [model.index[n] for n in model.rows[:, 0]]
    rigid = rigid_motions(model.places[nodes] - made.origin, model.rows)
    moved = rigid @ np.concatenate([velocity, spin]) + made.shapes @ rates
    return 0.5 * moved @ (model.mass @ moved)


@pytest.mark.parametrize("reference", [None, "root"])
def test_integrals_hold_the_mass_matrix(frame, reference):
    """Points and turning inertia have the kinetic energy of the mass matrix, coupled or not."""
    made = component_modes(frame, FRAME, 3, reference=reference)
    found, rng = inertia_integrals(made), np.random.default_rng(1)
    n = found.count
    spin, rates, velocity = rng.normal(size=3), rng.normal(size=n), rng.normal(size=3)
    energy = 0.0
    for point in found.points:
        speed = velocity + np.cross(spin, point[1:4]) + rates @ point[4:].reshape(n, 3)
        energy += 0.5 * found.mass / len(found.points) * speed @ speed
    motion = np.concatenate([spin, rates])
    energy += 0.5 * motion @ found.turning @ motion
    assert energy == pytest.approx(energy_of(made, spin, rates, velocity), rel=1e-11)


def test_integrals_of_lumped_masses():
    """A lumped mass matrix gives the sums over its nodes, also where the body is deformed."""
    block = lattice((4, 2, 2), 0.1)
    made = component_modes(block, {"left": [1, 2, 3, 4]}, 3, reference="left")
    found, rng = inertia_integrals(made), np.random.default_rng(2)
    n = found.count
    assert found.turning == pytest.approx(0.0, abs=1e-12 * found.mass)
    q = rng.normal(size=n)
    shapes = made.shapes.reshape(len(block.places), 3, n)
    at = block.places - made.origin + shapes @ q
    points = found.points[:, 1:4] + found.points[:, 4:].reshape(-1, n, 3).transpose(0, 2, 1) @ q
    share = found.mass / len(points)
    assert share * points.sum(axis=0) == pytest.approx(0.3 * at.sum(axis=0), rel=1e-11)
    assert share * points.T @ points == pytest.approx(0.3 * at.T @ at, rel=1e-11)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (({"root": 9}, 1), "has no node 9; the nearest number is 5"),
        (({"root": 1, "tip": [1, 2, 3]}, 1), "node 1 is also of 'root'; attach both to one"),
        ((FRAME, 13), "modes: 13 are more than are independent: .* has 12; give at most"),
        ((FRAME, 10**16), "modes: 10000000000000000 are more than are independent"),
        (({"root": 1}, 0), "modes: the body has none and would be rigid"),
        ((FRAME, 1, "top"), "reference: 'top' is no interface; interfaces are root, tip, side"),
    ],
)
def test_impossible_reductions(frame, arguments, words):
    interface, modes, *reference = arguments
    with pytest.raises(InputError, match=words):
        component_modes(frame, interface, modes, reference=reference[0] if reference else None)


def test_interfaces_must_hold_the_body():
    block = lattice((3, 2, 2), 0.1)
    with pytest.raises(InputError, match="does not hold the body of block, found at node"):
        component_modes(block, {"corner": 1}, 2)
    with pytest.raises(InputError, match="'corner' has no rotations and cannot hold the body"):
        component_modes(block, {"corner": 1}, 2, reference="corner")
    with pytest.raises(InputError, match="its nodes stand on a line"):
        component_modes(block, {"edge": [1, 2]}, 2)
