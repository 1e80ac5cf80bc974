"""Contact of the disc: defining equations, closed form, degenerate wheels."""

import math

import numpy as np
import pytest
from contact_search import find_contact

from vehicledyn.road.surfaces.bump import Bump
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.sine import Sine
from vehicledyn.road.wheel.contact import contact_on_plane
from vehicledyn.symbolic import ops

WAVY = Sine(amplitude_x=0.05, wavelength_x=2.0, amplitude_y=0.03, wavelength_y=3.0)
ROADS = [Flat(), Plane(slope_x=0.3, slope_y=-0.2), Bump(crest=0.2, length=5, start=0.97), WAVY]


def spin_axis(yaw, camber):
    cosine = math.cos(camber)
    return np.array([-math.sin(yaw) * cosine, math.cos(yaw) * cosine, math.sin(camber)])


@pytest.mark.parametrize("road", ROADS, ids=lambda r: r.kind)
@pytest.mark.parametrize("seed", range(8))
def test_defining_equations(road, seed):
    rng = np.random.default_rng(seed)
    place = rng.uniform(-5, 5, size=2)
    centre = np.array([*place, float(road.height(*place)) + rng.uniform(0.25, 0.6)])
    axis = spin_axis(rng.uniform(-3.1, 3.1), rng.uniform(-0.3, 0.3))
    c = find_contact(road, centre, axis, 0.33)
    reach = c.position - centre
    assert c.position[2] == pytest.approx(float(road.height(*c.position[:2])), abs=1e-12)
    assert reach @ axis == pytest.approx(0.0, abs=1e-12)
    assert reach @ c.longitudinal == pytest.approx(0.0, abs=1e-12)
    assert np.linalg.norm(reach) == pytest.approx(c.loaded_radius, abs=1e-12)
    frame = np.array([c.longitudinal, c.lateral, c.normal])
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=1e-12)
    assert math.sin(c.camber) == pytest.approx(c.normal @ axis, abs=1e-12)


@pytest.mark.parametrize("road", ROADS[:2], ids=lambda r: r.kind)
@pytest.mark.parametrize("height", [0.3, 0.9, -0.05])
def test_closed_form_agrees_with_newton(road, height):
    centre = np.array([0.7, -0.4, float(road.height(0.7, -0.4)) + height])
    axis = spin_axis(0.4, -0.1)
    found = find_contact(road, centre, axis, 0.33)
    closed = contact_on_plane(road, ops.vector(*centre), ops.vector(*axis), 0.33)
    assert [float(closed.position[k]) for k in range(3)] == pytest.approx(
        list(found.position), abs=1e-13
    )
    assert float(closed.deflection) == pytest.approx(found.deflection, abs=1e-13)
    assert float(closed.camber) == pytest.approx(found.camber, abs=1e-13)


def test_flat_ground_is_the_construction_of_the_benchmark():
    """Contact point = centre - r_w e_spoke with r_w = (z_c - z_P)/e_spoke_z."""
    centre, axis = np.array([1.0, 2.0, 0.34]), spin_axis(0.3, 0.08)
    along = np.cross(axis, [0, 0, 1])
    spoke = np.cross(along / np.linalg.norm(along), axis)
    radius = centre[2] / spoke[2]
    contact = find_contact(Flat(), centre, axis, 0.364325)
    assert contact.position == pytest.approx(centre - radius * spoke, abs=1e-14)
    assert contact.deflection == pytest.approx(0.364325 - radius, abs=1e-14)
    assert contact.camber == pytest.approx(math.atan(axis[2] / spoke[2]), abs=1e-14)


def test_a_wheel_that_leans_to_the_right_has_positive_camber():
    """Its top is at smaller y, so the left end of the axle points up."""
    assert find_contact(Flat(), [0, 0, 0.3], [0, 1, 0.1], 0.33).camber > 0.0


def test_wheel_far_from_the_origin():
    contact = find_contact(WAVY, [2000.3, -999.8, 0.35], [0, 1, 0], 0.33)
    near = find_contact(WAVY, [0.3, 0.2 - 1.0, 0.35], [0, 1, 0], 0.33)
    shift = contact.position - [2000.3, -999.8, 0.0]
    assert shift == pytest.approx(near.position - [0.3, -0.8, 0.0], abs=1e-9)


def test_closed_form_stays_finite_for_a_wheel_flat_on_the_ground():
    axis = ops.column([ops.symbol(k) for k in "xyz"])
    contact = contact_on_plane(Flat(), ops.vector(0, 0, 0.5), axis, 0.33)
    outputs = ops.column([contact.deflection, contact.camber, contact.position])
    expressions = (outputs, ops.jacobian(outputs, axis))
    values = [ops.numeric([axis], e)([0.0, 0.0, 1.0]) for e in expressions]
    assert all(np.isfinite(v).all() for v in values)
    assert values[0][0] < 0.0
