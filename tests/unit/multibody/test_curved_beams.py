"""Curved beams: statics by virtual work, rings by Hoppe and Michell, arcs bent straight."""

import numpy as np
import pytest
from beam_kernels import at_rest, frequencies, kernel_of
from scipy.linalg import expm

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import GROUND, Body, BodyCut, Joint
from vehicledyn.multibody.bodies.beam_properties import Properties, Stiffness
from vehicledyn.multibody.bodies.beam_shapes import assumed_shapes, quadrature
from vehicledyn.multibody.bodies.curved_axis import CurvedAxis
from vehicledyn.multibody.bodies.exact_beam import DIRECTIONS, ExactBeam
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes
from vehicledyn.symbolic import ops

RADIUS, LINE_MASS = 0.5, 3.0
GIVEN = Stiffness(mass_per_length=LINE_MASS, y=200.0, z=300.0, twist=150.0, polar=1e-6, stretch=1e9)
QUARTER = 0.5 * np.pi * RADIUS
ARC = (0.0, 0.0, 1.0 / RADIUS)
HELIX = (0.7, 0.5, 1.5)


def numbers(value):
    return np.array([[float(ops.scalar(value[i, j])) for j in range(value.shape[1])]
                     for i in range(value.shape[0])])  # fmt: skip


@pytest.mark.parametrize("curvature", [ARC, HELIX, (0.0, 0.0, 0.0)])
def test_places_and_turns_of_a_helix(curvature):
    """Against the exponential of its twist in space."""
    axis = CurvedAxis(curvature, 1.3)
    twist = np.zeros((4, 4))
    x, y, z = curvature
    twist[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    twist[0, 3] = 1.0
    for place in (0.0, 0.3, 1.0):
        pose = expm(1.3 * place * twist)
        assert numbers(axis.rotation(place)) == pytest.approx(pose[:3, :3], abs=1e-14)
        assert numbers(axis.position(place))[:, 0] == pytest.approx(pose[:3, 3], abs=1e-14)


def compliance(curvature, length, g, weight, along):
    """Return how far the end moves along a direction under its weight and the beam's own.

    Virtual work, ∫ (M m / E I + T t / G J) ds, with g the gravity, a vector.
    """
    axis = CurvedAxis(curvature, length)
    nodes, weights = quadrature(24)

    def place(s):
        return numbers(axis.position(float(s)))[:, 0]

    end, total = place(1.0), 0.0
    for s, share in zip(nodes, weights, strict=True):
        here, turn = place(s), numbers(axis.rotation(float(s)))
        moment = np.cross(end - here, weight * g)
        for u, part in zip(nodes, weights, strict=True):
            beyond = place(s + (1.0 - s) * u)
            moment += np.cross(beyond - here, LINE_MASS * g) * part * (1.0 - s) * length
        yields = np.array([1 / GIVEN.twist, 1 / GIVEN.z, 1 / GIVEN.y])
        own, unit = turn.T @ moment, turn.T @ np.cross(end - here, along)
        total += share * length * np.sum(own * unit * yields)
    return total


@pytest.mark.long
@pytest.mark.parametrize(
    ("settings", "within"),
    [
        ({"model": "exact", "modes": Modes(y=7, z=7, twist=7)}, 2e-6),
        ({"model": "segments", "segments": 16, "modes": Modes(y=1, z=1, twist=1)}, 2e-5),
    ],
)
@pytest.mark.parametrize("curvature", [ARC, HELIX])
def test_a_heavy_arc_with_a_weight_at_its_end(curvature, settings, within):
    g = 1e-4 * np.array([0.3, -0.5, -1.0])
    tip = Body("load", "beam.tip", mass=5.0)
    given = {"length": QUARTER, "stiffness": GIVEN, "curvature": curvature, **settings}
    seen = at_rest(kernel_of(tip, gravity=tuple(g), **given))
    for k, axis in enumerate("xyz"):
        moved = compliance(curvature, QUARTER, g, 5.0, np.eye(3)[k])
        assert seen[f"beam.tip_{axis}"] == pytest.approx(moved, rel=within)


@pytest.mark.long
def test_the_textbook_quarter_of_a_ring():
    """Loads at its end along its radius, its tangent and across its plane."""
    bent, twisted = RADIUS**3 / GIVEN.y, RADIUS**3 / GIVEN.twist
    none = np.zeros(3)
    for k, moved in enumerate(
        [
            bent * np.pi / 4,
            bent * (0.75 * np.pi - 2),
            RADIUS**3 / GIVEN.z * np.pi / 4 + twisted * (0.75 * np.pi - 2),
        ]
    ):
        unit = np.eye(3)[k]
        own = compliance(ARC, QUARTER, unit, 1.0, unit) - compliance(ARC, QUARTER, unit, 0.0, unit)
        assert own == pytest.approx(moved, rel=1e-12)
    assert compliance(ARC, QUARTER, none, 1.0, none) == 0.0


@pytest.mark.long
@pytest.mark.parametrize(("model", "within"), [("exact", (1e-5, 3e-3)), ("segments", (2e-4, 1e-3))])
def test_a_ring_in_its_plane(model, within):
    """Hoppe: ω² = E I n² (n² - 1)² / (μ R⁴ (n² + 1)); the ring closes by a weld."""
    found = ring(model, (Joint("T1", "x"), Joint("T2", "y")), Modes(y=12))
    for n, most in zip((2, 3), within, strict=True):
        exact = np.sqrt(GIVEN.y / LINE_MASS / (n**2 + 1)) * n * (n**2 - 1) / RADIUS**2
        assert np.min(np.abs(found / exact - 1.0)) < most


@pytest.mark.long
def test_a_ring_across_its_plane():
    """Michell: ω² = E I n² (n² - 1)² / (μ R⁴ (n² + E I / G J)); 1 + ν in Timoshenko's."""
    hub = (*(Joint(f"T{k}", f"along_{k}") for k in (1, 2, 3)), Joint("R1", "roll"))
    found = ring("segments", (*hub, Joint("R2", "pitch")), Modes(y=1, z=1, twist=1))
    ratio = GIVEN.z / GIVEN.twist
    for n, most in ((2, 2e-4), (3, 1e-3)):
        whole = n**2 + ratio
        exact = np.sqrt(GIVEN.z / LINE_MASS / whole) * n * (n**2 - 1) / RADIUS**2
        assert np.min(np.abs(found / exact - 1.0)) < most


def ring(model, hub, modes):
    weld = BodyCut("weld", "beam.tip", (0.0, 0.0, 0.0), "hub", (0.0, 0.0, 0.0))
    settings = {"length": 2 * np.pi * RADIUS, "stiffness": GIVEN, "curvature": ARC}
    kernel = kernel_of(hub=hub, cuts=(weld,), model=model, modes=modes, segments=24, **settings)
    return frequencies(kernel)


def test_an_arc_bent_straight_holds_the_energy_of_its_curvature():
    """With the angle -K s its axis is straight, and ½ E I K² L is stored."""
    made = {
        d: assumed_shapes(4 if d == "y" else 0, 2 if d in ("y", "z") else 1) for d in DIRECTIONS
    }
    beam = ExactBeam("b", QUARTER, Properties(GIVEN), made, CurvedAxis(ARC, QUARTER))
    places = np.linspace(0.05, 0.95, 9)
    shapes = np.array([made["y"].values(x, 1) for x in places]) / QUARTER
    q = np.linalg.lstsq(shapes, -places * QUARTER / RADIUS, rcond=None)[0]
    assert shapes @ q == pytest.approx(-places * QUARTER / RADIUS, abs=1e-12)
    end = beam.deflection(1.0, list(q))
    assert numbers(end.position)[:, 0] == pytest.approx([QUARTER, 0.0, 0.0], abs=1e-12)
    assert numbers(end.rotation) == pytest.approx(np.eye(3), abs=1e-12)
    energy = 0.5 * GIVEN.y / RADIUS**2 * QUARTER
    assert float(beam.energy(list(q))) == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"model": "modes"}, "take 'model: exact' or 'model: segments'"),
        ({"model": "exact", "end_stiffness": GIVEN}, "a tapered beam is straight"),
    ],
)
def test_refused(change, words):
    with pytest.raises(InputError, match=words):
        Beam(
            "b", body=GROUND, length=1.0, stiffness=GIVEN, curvature=ARC, modes=Modes(y=2), **change
        )
