"""Beams against closed forms: deflections, frequencies, stiffening by rotation, buckling loads."""

import numpy as np
import pytest
from beam_kernels import (
    BENDING,
    GIVEN,
    LENGTH,
    MASS,
    PACE,
    POLAR,
    STRETCH,
    TWIST,
    at_rest,
    frequencies,
    kernel_of,
    matrix_of,
)
from numpy.polynomial import Legendre

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.multibody import (
    GROUND,
    Body,
    BodyCut,
    Joint,
    RodCut,
)
from vehicledyn.multibody.bodies.beam_properties import Material, Stiffness
from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes
from vehicledyn.multibody.joints.joint_type import joint_kinds, joint_type

pytestmark = pytest.mark.long

MODEL = [
    ({"model": "modes"}, {"y": 8, "z": 8, "twist": 8, "stretch": 8}),
    ({"model": "segments", "segments": 9}, {"z": 1, "stretch": 1}),
]


@pytest.mark.parametrize("direction", ["y", "z"])
def test_clamped_free(direction):
    found = frequencies(kernel_of(modes=Modes(**{direction: 8})))[:3] / PACE
    assert found == pytest.approx([3.51601526850015, 22.0344915646668, 61.6972144135491], rel=3e-6)


def test_clamped_free_of_segments():
    """They converge with the fourth power of their number: 16 are as good as modes."""
    kernel = kernel_of(model="segments", segments=16, modes=Modes(z=1))
    assert frequencies(kernel)[:2] / PACE == pytest.approx([3.516015268, 22.0344915647], rel=2e-5)


def test_loops_hold_its_end():
    """Clamped at both ends by a cut, and on a hinge at both: modes become dependent."""
    cut = BodyCut("clamp", "beam.tip", (0.0, 0.0, 0.0), "hub", (LENGTH, 0.0, 0.0))
    clamped = kernel_of(cuts=(cut,), modes=Modes(z=8, stretch=1))
    assert frequencies(clamped)[0] / PACE == pytest.approx(22.3732854480613, rel=1e-4)
    pin = (Joint("R2", "pin"),)
    rod = RodCut("rod", "beam.tip", (0.0, 0.0, 0.0), GROUND, (LENGTH, 0.0, 1e3), 1e3)
    hinged = kernel_of(cuts=(rod,), hub=pin, modes=Modes(z=8))
    assert frequencies(hinged)[0] / PACE == pytest.approx(np.pi**2, rel=1e-4)


def test_free_free():
    """The start is free to slide and to turn: the clamped shapes and these motions span all."""
    loose = (Joint("T3", "lift"), Joint("R2", "pitch"))
    found = frequencies(kernel_of(hub=loose, modes=Modes(z=8)))[2:4] / PACE
    assert found == pytest.approx([22.3732854480613, 61.6728228679202], rel=1e-4)


@pytest.mark.parametrize(
    ("modes", "stiffness", "inertia"),
    [(Modes(twist=8), TWIST, POLAR), (Modes(stretch=8), STRETCH, MASS)],
)
def test_twist_and_stretch(modes, stiffness, inertia):
    found = frequencies(kernel_of(modes=modes))[:3]
    speed = np.sqrt(stiffness / inertia) / LENGTH
    assert found == pytest.approx(np.pi * np.array([0.5, 1.5, 2.5]) * speed, rel=2e-5)


@pytest.mark.parametrize(
    ("direction", "stiffness", "inertia", "hub", "orders"),
    [
        ("twist", TWIST, POLAR, (), [0.5, 1.5, 2.5]),
        ("stretch", STRETCH, MASS, (Joint("T1", "loose"),), [1.0, 2.0, 3.0]),
    ],
)
def test_twist_and_stretch_of_segments(direction, stiffness, inertia, hub, orders):
    """Clamped-free and free-free: without their negative reflected inertias 3e-3 too low."""
    kernel = kernel_of(hub=hub, model="segments", segments=32, modes=Modes(**{direction: 1}))
    found = frequencies(kernel)[len(hub) :][:3]
    speed = np.sqrt(stiffness / inertia) / LENGTH
    assert found == pytest.approx(np.pi * np.array(orders) * speed, rel=3e-5)


ROTATING = {
    0.0: {3: ([4.797279, 23.320264, 62.984967], [3.743512, 23.126493, 62.913481]),
          12: ([13.170150, 37.603112, 79.614478], [5.427049, 35.636976, 78.704925])},
}  # fmt: skip
"""Flap and chord frequencies by hub radius over length and speed; own Legendre-Ritz solution."""

_SQUARE = Legendre([1.0 / 3.0, 0.5, 1.0 / 6.0], domain=[0.0, 1.0])
"""x² on the interval from 0 to 1."""


@pytest.mark.parametrize("speed", ROTATING[0.0])
def test_rotation_stiffens_it(speed):
    """Modes 1 to 3, the chord ones without Coriolis forces: the beam does not stretch."""
    flap, chord = ROTATING[0.0][speed]
    for direction, expected in (("z", flap), ("y", chord)):
        kernel = kernel_of(speed=speed * PACE, modes=Modes(**{direction: 8}))
        assert frequencies(kernel)[:3] / PACE == pytest.approx(expected, rel=2e-5)


def ritz(speed, radius, count=16):
    """Return the first flap frequencies of Rayleigh and Ritz with x² times Legendre polynomials."""
    x, w = np.polynomial.legendre.leggauss(40)
    x, w = 0.5 * (1.0 + x), 0.5 * w
    shapes = [Legendre([0.0] * k + [1.0], domain=[0.0, 1.0]) * _SQUARE for k in range(count)]
    moved, slope, bent = (np.array([s.deriv(m)(x) for s in shapes]) for m in (0, 1, 2))
    pull = speed**2 * (radius * (1.0 - x) + 0.5 * (1.0 - x**2))
    stiff = (bent * w) @ bent.T + (slope * w * pull) @ slope.T
    root = np.linalg.inv(np.linalg.cholesky((moved * w) @ moved.T))
    return np.sqrt(np.linalg.eigvalsh(root @ stiff @ root.T))[:3]


@pytest.mark.parametrize("radius", [1.0, 5.0])
@pytest.mark.parametrize("direction", ["z", "y"])
def test_a_hub_of_some_radius_stiffens_it_more(radius, direction):
    """Flap modes 1 to 3 and, without their Coriolis forces, chord modes, ω² less by Ω²."""
    speed = 12.0
    at = (radius * LENGTH, 0.0, 0.0)
    kernel = kernel_of(speed=speed * PACE, at=at, modes=Modes(**{direction: 8}))
    expected = np.sqrt(ritz(speed, radius) ** 2 - (speed**2 if direction == "y" else 0.0))
    assert frequencies(kernel)[:3] / PACE == pytest.approx(expected, rel=1e-3)


def test_the_solution_beside_it_is_that_of_the_tables():
    assert ritz(12.0, 0.0) == pytest.approx(ROTATING[0.0][12][0], rel=1e-7)


@pytest.mark.parametrize("ratio", [0.1, 1.0])
def test_a_body_at_its_end_slows_it(ratio):
    """beam_closed_forms.csv: 1 + c ch + r β (c sh - s ch) = 0."""
    expected = {
        0.1: [2.96783834677597, 19.3558010098773, 55.5182455487865],
        1.0: [1.55729786119892, 16.2500851582386, 50.895842831216],
    }
    tip = Body("load", "beam.tip", mass=ratio * MASS * LENGTH)
    found = frequencies(kernel_of(tip, modes=Modes(z=8)))[:3] / PACE
    assert found == pytest.approx(expected[ratio], rel=1e-5)


@pytest.mark.parametrize(("settings", "counts"), MODEL)
def test_static_deflection(settings, counts):
    """Sag and slope of a heavy cantilever, q L⁴/8 E I, and its stretch where it hangs."""
    g = 1e-6
    few = {name: min(count, 4) for name, count in counts.items()}
    kernel = kernel_of(gravity=(g, 0.0, -g), modes=Modes(**few), **settings)
    seen = at_rest(kernel)
    assert seen["beam.tip_z"] == pytest.approx(-MASS * g * LENGTH**4 / (8 * BENDING), rel=1e-4)
    assert seen["beam.tip_x"] == pytest.approx(MASS * g * LENGTH**2 / (2 * STRETCH), rel=2e-3)


@pytest.mark.parametrize("model", ["modes", "exact"])
def test_section_loads_and_stress(model):
    """A weight at the end of a heavy strip of steel: M = -(F + q L/2) L at the start."""
    section, steel = Section(shape="rectangle", width=0.02, height=0.01), 210e9
    tip, g, density = Body("load", "beam.tip", mass=3.0), 1e-3, 7850.0
    kernel = kernel_of(
        tip, gravity=(0.0, 0.0, -g), model=model, stiffness=None, section=section, frames=(0.5,),
        material=Material(density=density, young=steel), modes=Modes(z=5), stresses=True,
    )  # fmt: skip
    seen = at_rest(kernel)
    line = density * 2e-4 * g

    def moment(x):
        return 3.0 * g * (LENGTH - x) + 0.5 * line * (LENGTH - x) ** 2

    # A deflection downwards is a turn about +y, and so is the moment on the inner part.
    assert seen["beam.start.moment_y"] == pytest.approx(moment(0.0), rel=1e-6)
    assert seen["beam.frame_1.moment_y"] == pytest.approx(moment(0.5 * LENGTH), rel=1e-6)
    stress = moment(0.0) * 0.005 / (0.02 * 0.01**3 / 12.0)
    assert seen["beam.start.stress"] == pytest.approx(stress, rel=1e-6)
    third = stress * moment(LENGTH * 2.5 / 8.0) / moment(0.0)
    assert seen["beam.piece_3.stress"] == pytest.approx(third, rel=1e-6)
    if model == "modes":
        shear = 3.0 * g + line * 0.5 * LENGTH
        assert seen["beam.frame_1.shear_force_z"] == pytest.approx(-shear, rel=1e-6)


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ({"modes": Modes(y=5, z=3, twist=4)}, 1e-3),
        ({"model": "segments", "segments": 8, "modes": Modes(y=1, z=1, twist=1)}, 0.008),
        ({"model": "segments", "segments": 8, "modes": Modes(y=1, twist=1)}, 0.03),
    ],
)
def test_a_tip_force_buckles_it_sideways(settings, tolerance):
    """P L²/√(E I_minor G J) = 4.0126 for a narrow strip: its lateral frequency vanishes there.

    Segments converge with the square of their number: 0.75 % with 8, 0.05 % with 32; without z
    2.1 % and 0.15 %.
    """
    strip = Stiffness(mass_per_length=MASS, y=1.0, z=1e4, twist=2.0, polar=0.1)
    critical = 4.0125993435789 * np.sqrt(2.0) / LENGTH**2

    def lateral(load):
        """Return the least ω² of bending along y and twist under a dead tip force along z."""
        mass = 1e4
        tip = Body("load", "beam.tip", mass=mass)
        kernel = kernel_of(tip, gravity=(0.0, 0.0, -load / mass), stiffness=strip, **settings)
        e = kernel.equations
        n, x = len(e.states) // 2, np.zeros(len(e.states))
        bent = [k for k, s in enumerate(e.states[:n]) if ".z_" in s.name]
        matrix, rows = matrix_of(kernel), [n + k for k in bent]
        for _ in range(3 if bent else 0):
            rates = kernel.rates(0.0, x, np.zeros(0))
            x[bent] -= np.linalg.solve(matrix[np.ix_(rows, bent)], rates[rows])
        side = [k for k in range(n) if k not in bent]

        def push(amplitudes):
            y = x.copy()
            y[side] = amplitudes
            return kernel.rates(0.0, y, np.zeros(0))[n:][side]

        slopes = [(push(1e-5 * d) - push(-1e-5 * d)) / 2e-5 for d in np.eye(len(side))]
        return np.linalg.eigvals(-np.array(slopes).T).real.min()

    low, high = (lateral(part * critical) for part in (1.0 - tolerance, 1.0 + tolerance))
    assert low > 0.0 > high


THIN = Stiffness(mass_per_length=MASS, z=BENDING)
"""Without the inertia of sections, which tilts segments in a rotor."""


def test_rotation_stiffens_segments():
    """Flap at a speed of 12: without what their joints give back 3e-4, 8e-4 and 1.3e-3 too high."""
    given = {"model": "segments", "segments": 32, "modes": Modes(z=1), "stiffness": THIN}
    found = frequencies(kernel_of(speed=12.0 * PACE, **given))[:3] / PACE
    assert found == pytest.approx(ROTATING[0.0][12][0], rel=2e-5)


def test_a_column_of_segments_buckles():
    """Under π² E I/4 L² on its end: without what joints give back 3.6e-3 too early."""
    mass, load = 1e3, np.pi**2 * BENDING / 4.0 / LENGTH**2
    given = {"model": "segments", "segments": 8, "modes": Modes(z=1), "stiffness": THIN}
    slowest = []
    for part in (0.999, 1.001):
        tip = Body("load", "beam.tip", mass=mass)
        kernel = kernel_of(tip, gravity=(-part * load / mass, 0.0, 0.0), **given)
        n = len(kernel.equations.states) // 2
        slowest.append(np.linalg.eigvals(-matrix_of(kernel)[n:, :n]).real.min())
    assert slowest[0] > 0.0 > slowest[1]


@pytest.mark.parametrize("count", [1, 2, 3, 5, 7])
def test_few_segments_turn_their_end_by_a_moment(count):
    """Exactly, and what all joints give back is that of each: the end moves along by -½ L ϑ² ..."""
    moment = 1e-3 * BENDING / LENGTH
    push = ExternalWrench("push", body="beam.tip", torque=lambda t: (0.0, -moment, 0.0))
    given = {"model": "segments", "segments": count, "modes": Modes(z=1), "stiffness": THIN}
    seen = at_rest(kernel_of(parts=(push,), **given))
    angle = moment * LENGTH / BENDING
    assert seen["beam.strain_energy"] == pytest.approx(0.5 * moment * angle, rel=1e-6)
    assert seen["beam.tip_x"] == pytest.approx(-LENGTH * angle**2 / 6.0, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"stiffness": None}, "give a section or a stiffness, not neither"),
        ({"section": Section(shape="circle", radius=0.1)}, "not both"),
        ({"modes": Modes()}, "would be rigid"),
        ({"modes": Modes(z=13)}, "not independent"),
        ({"frames": (1.2,)}, "1.2 is beyond the beam"),
        ({"segments": 4_000_000}, "segments: 4e\\+06 is not from 1 to 1000"),
        ({"segments": 0}, "segments: 0 is not from 1 to 1000"),
        ({"stiffness": Stiffness(mass_per_length=1.0, y=1.0)}, "no stiffness in it"),
        ({"material": Material(density=1.0, young=1.0)}, "leave it out"),
    ],
)
def test_what_is_no_beam_is_refused(change, words):
    settings = {"length": LENGTH, "stiffness": GIVEN, "modes": Modes(z=2)} | change
    with pytest.raises(InputError, match=words):
        Beam("beam", body=GROUND, **settings)


def test_a_body_hangs_on_frames_only():
    with pytest.raises(InputError, match="which deforms; hang it on a frame"):
        kernel_of(Body("load", "beam", mass=1.0), modes=Modes(z=2))


def test_a_coordinate_of_a_deformation_is_no_joint():
    found = [joint_type("deformation", {"measure": unit}) for unit in ("m", "rad")]
    assert not any(item.makes_link for item in found)
    assert [item.force_unit for item in found] == ["N", "N*m"]


@pytest.mark.parametrize("kind", kinds("deformation_type"))
def test_files_name_nothing_that_beams_bring_along(kind):
    assert kind not in joint_kinds()


def test_sections():
    """Areas, moments and torsion constants against handbooks (Young, Budynas, table 10.1)."""
    square = Section(shape="rectangle", width=2.0, height=2.0).numbers
    assert square.torsion == pytest.approx(0.140577 * 16.0, rel=1e-5)
    strip = Section(shape="rectangle", width=1.0, height=10.0).numbers
    assert (strip.along_y, strip.along_z) == pytest.approx((10.0 / 12.0, 1000.0 / 12.0))
    assert strip.torsion == pytest.approx(0.312 * 10.0, rel=2e-3)
    tube = Section(shape="tube", radius=2.0, thickness=1.0).numbers
    assert (tube.area, tube.torsion) == pytest.approx((3.0 * np.pi, 7.5 * np.pi))
    beam = Section(shape="i_section", width=4.0, height=10.0, web=0.5, flange=1.0).numbers
    assert beam.area == pytest.approx(12.0)
    assert beam.along_z == pytest.approx(2.0 * (4.0 / 12.0 + 4.0 * 4.5**2) + 0.5 * 8.0**3 / 12.0)
    with pytest.raises(InputError, match="a circle needs its radius"):
        Section(shape="circle")
    with pytest.raises(InputError, match="a circle has no height"):
        Section(shape="circle", radius=1.0, height=2.0)
