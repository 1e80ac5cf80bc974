"""Soft ground: closed forms, quadrature, mirror images and power that is never negative."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad

import vehicledyn.road  # noqa: F401
from vehicledyn.base.registry import find, kinds
from vehicledyn.road.limits import RoadLimits
from vehicledyn.road.wheel.soft_ground import soil_forces

SAND = {
    "wheel_width": 0.3,
    "cohesion": "1 kPa",
    "friction_angle": "30 deg",
    "shear_modulus": "25 mm",
    "exponent": 1.1,
}
EXAMPLES = {
    "bekker": {"cohesive_modulus": 1e3, "frictional_modulus": "1.5 MPa"},
    "reece": {"cohesive_factor": 20, "frictional_factor": 900, "unit_weight": 15e3},
}
R = 0.45


def soil(kind="bekker", **changes):
    return find("soil", kind)(**SAND | EXAMPLES[kind] | changes)


@pytest.mark.parametrize("kind", kinds("soil"))
def test_pressure_grows_with_the_power_of_the_sinkage(kind):
    law = soil(kind)
    assert law.pressure(0.2) / law.pressure(0.1) == pytest.approx(2.0**1.1)


def test_pressures_by_hand():
    assert soil().pressure(0.1) == pytest.approx((1e3 / 0.3 + 1.5e6) * 0.1**1.1)
    found = soil("reece").pressure(0.1)
    assert found == pytest.approx((1e3 * 20 + 15e3 * 0.3 * 900) * (0.1 / 0.3) ** 1.1)


def by_quadrature(law, depth, slip, angle):
    """Return the forces by adaptive quadrature of the formulas as published, driven forwards."""
    s = slip / (1.0 + slip)
    entry = math.acos(1.0 - depth / R)
    crest = (law.front_share + law.slip_share * max(s, 0.0)) * entry

    def pressure(place):
        return law.pressure(max(R * (math.cos(place) - math.cos(entry)), 1e-12))

    def stresses(place):
        seen = place if place > crest else entry - place / crest * (entry - crest)
        j_x = R * ((entry - place) - (1.0 - s) * (math.sin(entry) - math.sin(place)))
        j_y = R * (1.0 - s) * (entry - place) * math.tan(angle)
        j, sigma = math.hypot(j_x, j_y), pressure(seen)
        tau = (law.cohesion + sigma * math.tan(law.friction_angle)) * (
            1.0 - math.exp(-j / law.shear_modulus)
        )
        return (sigma, tau * j_x / j, tau * j_y / j) if j > 0.0 else (sigma, 0.0, 0.0)

    def integral(part):
        area = law.wheel_width * R
        halves = ((0.0, crest), (crest, entry))
        return sum(quad(lambda t: part(t, *stresses(t)) * area, *h, epsabs=1e-9)[0] for h in halves)

    return SimpleNamespace(
        load=integral(lambda t, n, x, y: n * math.cos(t) + x * math.sin(t)),
        pull=integral(lambda t, n, x, y: x * math.cos(t) - n * math.sin(t)),
        side=integral(lambda t, n, x, y: -y),
        torque=integral(lambda t, n, x, y: x * R),
        turning=integral(lambda t, n, x, y: -y * R * math.sin(t)),
    )


@pytest.mark.parametrize(("slip", "angle"), [(0.0, 0.0), (0.25, 0.05), (3.0, -0.2), (-0.3, 0.1)])
def test_the_rule_of_twelve_points_integrates_the_formulas(slip, angle):
    for depth in (0.005, 0.03, 0.1):
        wanted = by_quadrature(soil(), depth, slip, angle)
        found = soil_forces(soil(), R, depth, slip=slip, side_slip=math.tan(angle))
        for name in ("load", "pull", "side", "torque", "turning"):
            close = pytest.approx(getattr(wanted, name), abs=2e-3 * wanted.load)
            assert getattr(found, name) == close, (depth, name)


def test_compaction_resistance_of_soil_without_strength_is_bekkers():
    """Work of pressing the rut, b ∫ p dz, where the pressure is largest at the lowest point."""
    law = soil(cohesion=0.0, friction_angle=0.0, front_share=1e-6, exponent=1.0, slip_share=0.0)
    found = soil_forces(law, R, 0.05, slip=0.0)
    assert found.pull == pytest.approx(-0.3 * law.pressure(0.05) * 0.05 / 2.0, rel=1e-4)
    assert abs(found.torque) < 1e-6


def test_a_wheel_that_only_spins_shears_the_soil_wholly():
    """At a slip without bound τ is the strength everywhere: torque R²b ∫ (c + σ tan φ) dθ."""
    law = soil(friction_angle=0.0, shear_modulus=1e-4)
    entry = math.acos(1.0 - 0.04 / R)
    found = soil_forces(law, R, 0.04, slip=1e6)
    assert found.torque == pytest.approx(R * R * 0.3 * 1e3 * entry, rel=0.02)


def test_backwards_is_the_mirror_image_of_forwards():
    ahead = soil_forces(soil(), R, 0.04, slip=0.2, side_slip=0.1)
    back = soil_forces(soil(), R, 0.04, slip=-0.2, side_slip=0.1, direction=-1.0)
    assert (back.load, back.side) == pytest.approx((ahead.load, ahead.side), rel=1e-12)
    assert (back.pull, back.torque) == pytest.approx((-ahead.pull, -ahead.torque), rel=1e-12)


def test_power_is_never_gained():
    """Power of the torque less that of pull and side force is lost in the soil."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        slip, tangent = rng.uniform(-0.95, 4.0), rng.uniform(-0.5, 0.5)
        found = soil_forces(soil(), R, rng.uniform(1e-3, 0.15), slip=slip, side_slip=tangent)
        lost = found.torque * (1.0 + slip) / R - found.pull - found.side * tangent
        assert lost > 0.0


def test_a_wheel_that_sinks_in_soil_is_no_matter_of_the_step():
    for ground, words in ((None, "step too long"), (soil(), "the soil does not carry it")):
        wheel = SimpleNamespace(surface=SimpleNamespace(soil=ground))
        assert words in RoadLimits("car", body=None, wheels=(wheel,))._sunk
