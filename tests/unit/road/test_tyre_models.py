"""Brush, TMeasy and the formula of 1989 against what defines them, computed another way."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import vehicledyn.road  # noqa: F401
from vehicledyn.road.tyres.brush import Brush
from vehicledyn.road.tyres.magic_formula_1989 import MagicFormula1989
from vehicledyn.road.tyres.tmeasy import Points, TMeasy
from vehicledyn.road.tyres.tyre import TyreInput

BRUSH = Brush(nominal_load=4e3, slip_stiffness=80e3, half_length=0.06, friction=0.9)
ALONG = Points(
    slope=(120e3, 200e3),
    peak_slip=(0.11, 0.12),
    peak_force=(3.3e3, 6e3),
    sliding_slip=(0.5, 0.6),
    sliding_force=(3e3, 5.7e3),
)
ACROSS = Points(
    slope=(55e3, 80e3),
    peak_slip=(0.2, 0.22),
    peak_force=(3.1e3, 5.4e3),
    sliding_slip=(0.8, 0.9),
    sliding_force=(3e3, 5.3e3),
)
TMEASY = TMeasy(nominal_load=3e3, longitudinal=ALONG, lateral=ACROSS, trail=0.03)


def forces(law, *felt):
    found = law.forces(TyreInput(*felt))
    return tuple(
        float(x) for x in (found.longitudinal_force, found.lateral_force, found.aligning_moment)
    )


@pytest.mark.parametrize("load", [2000.0, 4000.0, 7000.0])
@pytest.mark.parametrize(("slip", "angle"), [(0.03, 0.0), (0.0, 0.05), (-0.04, 0.03), (0.3, 0.4)])
def test_brush_is_the_integral_over_its_bristles(load, slip, angle):
    """Bristles of stiffness C/(2 a²) slide where they ask for more than the pressure holds."""
    a = 0.06 * math.sqrt(load / 4e3)
    stiffness = 80e3 * load / 4e3 / (2.0 * a * a)
    sx, sy = slip / (1.0 + slip), math.tan(angle) / (1.0 + slip)
    size = math.hypot(sx, sy)

    def shear(x):  # x from the leading edge backwards
        pressure = 0.75 * load / a * (1.0 - ((a - x) / a) ** 2)
        return min(stiffness * size * x, 0.9 * pressure)

    kink = max(2.0 * a * (1.0 - 80e3 * size / (3.0 * 0.9 * 4e3)), 0.0)
    parts = [(0.0, kink), (kink, 2.0 * a)]
    force = sum(quad(shear, *p, epsabs=1e-11, epsrel=1e-13)[0] for p in parts)
    lever = sum(
        quad(lambda x: shear(x) * (x - a), *p, epsabs=1e-11, epsrel=1e-13)[0] for p in parts
    )
    wanted = (force * sx / size, -force * sy / size, lever * sy / size)
    assert forces(BRUSH, load, slip, angle, 0.0) == pytest.approx(wanted, abs=1e-7, rel=1e-9)


def test_brush_at_full_stick_and_locked():
    stiff, _, _ = forces(BRUSH, 4e3, 1e-5, 0.0, 0.0)
    assert stiff / 1e-5 == pytest.approx(80e3, rel=1e-3)
    assert forces(BRUSH, 4e3, -1.0, 0.0, 0.0) == pytest.approx((-3600.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(("load", "which"), [(3e3, 0), (6e3, 1)])
def test_tmeasy_goes_through_its_points(load, which):
    for points, column, sign in ((ALONG, 0, 1.0), (ACROSS, 1, -1.0)):

        def at(slip, column=column, sign=sign):
            felt = (slip / (1.0 - slip), 0.0) if column == 0 else (0.0, math.atan(slip))
            return sign * forces(TMEASY, load, *felt, 0.0)[column]

        peak, end = points.peak_slip[which], points.sliding_slip[which]
        assert at(peak) == pytest.approx(points.peak_force[which], rel=1e-9)
        assert at(end) == pytest.approx(points.sliding_force[which], rel=1e-9)
        assert at(0.95) == pytest.approx(points.sliding_force[which], rel=1e-9)
        assert at(1e-6) / 1e-6 == pytest.approx(points.slope[which], rel=1e-4)
        assert (at(peak + 1e-6) - at(peak - 1e-6)) / 2e-6 == pytest.approx(0.0, abs=2.0)


def test_tmeasy_between_loads_is_a_parabola():
    slopes = [forces(TMEASY, f * 3e3, 1e-6, 0.0, 0.0)[0] * 1e6 for f in (0.5, 1.0, 1.5, 2.0)]
    assert np.diff(np.array(slopes), n=3) == pytest.approx(0.0, abs=20.0)


def test_tmeasy_trail():
    _, fy, moment = forces(TMEASY, 3e3, 0.0, 1e-5, 0.0)
    assert moment / -fy == pytest.approx(0.03, rel=1e-3)
    assert forces(TMEASY, 3e3, 0.0, math.atan(0.2), 0.0)[2] == pytest.approx(0.0, abs=1e-6)
    assert forces(TMEASY, 3e3, 0.0, math.atan(0.3), 0.0)[2] < 0.0
    assert forces(TMEASY, 3e3, 0.0, math.atan(0.6), 0.0)[2] == pytest.approx(0.0, abs=1e-9)


A = (1.65, -34.0, 1250.0, 3036.0, 12.8, 0.00501, -0.02103, 0.77394, 0.002289, 0.013442, 0.003709)
A += (19.1656, 1.21356, 6.26206)
B = (1.67272, -9.46, 1490.0, 30.0, 276.0, 0.0886, 0.00402, -0.0615, 1.2, 0.02, 0.03)
C = (2.34, 1.495, 6.416654, -3.57403, -0.087737, 0.09841, 0.0027699, -1e-4, 0.1, -1.33329)
C += (0.025501, -0.02357, 0.03027, -0.0647, 0.0211329, 0.89469, -0.099443, -3.336941)
GENTA = MagicFormula1989(lateral=A, longitudinal=B, aligning=C)


@pytest.mark.parametrize("load", [2.0, 4.0, 6.0])
def test_formula_of_1989_at_pure_slip(load):
    angle, F = 4.0, load
    D, K = (A[1] * F + A[2]) * F, A[3] * math.sin(2.0 * math.atan(F / A[4]))
    x = angle + A[9] * F + A[10]
    u, E = K / (A[0] * D) * x, A[6] * F + A[7]
    y = D * math.sin(A[0] * math.atan(u - E * (u - math.atan(u)))) + A[12] * F + A[13]
    found = forces(GENTA, 1e3 * load, -B[9] * F / 100 - B[10] / 100, math.radians(angle), 0.0)
    assert found[1] == pytest.approx(-y, rel=1e-9)
    D, K = (B[1] * F + B[2]) * F, (B[3] * F + B[4]) * F * math.exp(-B[5] * F)
    x, E = 5.0 + B[9] * F + B[10], (B[6] * F + B[7]) * F + B[8]
    E = min(E, 1.0)
    u = K / (B[0] * D) * x
    y = D * math.sin(B[0] * math.atan(u - E * (u - math.atan(u))))
    level = -math.radians(A[9] * F + A[10])
    assert forces(GENTA, 1e3 * load, 0.05, level, 0.0)[0] == pytest.approx(y, rel=1e-9)


def test_formula_of_1989_refuses_lists_of_another_length():
    with pytest.raises(Exception, match="expected 14 coefficients, found 2"):
        MagicFormula1989(lateral=(1.0, 2.0), longitudinal=B, aligning=C)


@pytest.mark.parametrize("law", [BRUSH, TMEASY])
def test_energy_is_never_created(law):
    """Force against the sliding velocity of the contact, (κ, tan α) over any slip and load."""
    rng = np.random.default_rng(2)
    for load, slip, angle in rng.uniform([0, -3, -1.5], [9e3, 3, 1.5], size=(400, 3)):
        fx, fy, _ = forces(law, load, slip, angle, 0.0)
        assert fx * slip - fy * math.tan(angle) >= 0.0


def test_brush_is_its_closed_form_to_1e_9_newtons():
    rng = np.random.default_rng(3)
    for load, stiffness, friction, slip, angle in rng.uniform(
        [500, 2e4, 0.1, -0.9, -1.2], [9e3, 2e5, 1.5, 2.0, 1.2], size=(200, 5)
    ) * [1, 1, 1, rng.choice([1, 1e-3]), rng.choice([1, 1e-3])]:
        law = Brush(nominal_load=4e3, slip_stiffness=stiffness, half_length=0.06, friction=friction)
        along, across = slip / (1 + slip), math.tan(angle) / (1 + slip)
        size = math.hypot(along, across)
        u = min(1.0, stiffness * size / (3 * friction * 4e3))
        force = friction * load * (1 - (1 - u) ** 3)
        moment = friction * load * 0.06 * math.sqrt(load / 4e3) * u * (1 - u) ** 3
        found = law.forces(TyreInput(load, slip, angle, 0.0, 10.0))
        assert found.longitudinal_force == pytest.approx(force * along / size, abs=1e-9)
        assert found.lateral_force == pytest.approx(-force * across / size, abs=1e-9)
        assert found.aligning_moment == pytest.approx(moment * across / size, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sliding_slip": (0.05, 0.06)}, "sliding_slip: must lie beyond peak_slip"),
        ({"peak_force": (3.3e3, 3e3)}, "peak_force: must grow with the load"),
        ({"slope": (0.0, 0.0)}, "slope: must be above zero"),
        ({"peak_slip": (0.11, 0.02)}, "peak_slip: the straight line through both values"),
    ],
)
def test_points_of_tmeasy_that_no_curve_joins_are_refused(change, words):
    with pytest.raises(ValueError, match=words):
        Points(**{**ALONG.model_dump(), **change})


def test_a_trail_that_ends_before_it_is_zero_is_refused():
    with pytest.raises(ValueError, match="trail_end_slip: must lie beyond trail_zero_slip"):
        TMeasy(nominal_load=3e3, longitudinal=ALONG, lateral=ACROSS, trail_end_slip=0.2)


def test_the_formula_of_1989_needs_stiffness_and_peaks_but_no_moment():
    quiet = MagicFormula1989(lateral=A, longitudinal=B, aligning=(2.4, *([0.0] * 17)))
    assert forces(quiet, 4e3, 0.05, 0.05, 0.0)[2] == 0.0
    for place in (3, 4):
        flat = tuple(0.0 if k == place else value for k, value in enumerate(A))
        with pytest.raises(ValueError, match=f"number {place}, counted from 0, must not be zero"):
            MagicFormula1989(lateral=flat, longitudinal=B, aligning=C)
