"""Contacts that look straight down: the Iltis benchmark's rule and the exact tangent plane."""

import math

import numpy as np
import pytest

from vehicledyn.road.surfaces.bump import Bump
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.sine import Sine
from vehicledyn.road.wheel.contact import contact_on_plane
from vehicledyn.road.wheel.contact_below import (
    contact_below,
    contact_of_lowest_point,
    contact_on_tangent_plane,
)
from vehicledyn.symbolic import ops

RADIUS = 0.364325
WAVY = Sine(amplitude_x=0.05, wavelength_x=2.0, amplitude_y=0.03, wavelength_y=3.0)
ROADS = [Flat(), Plane(slope_x=0.1, slope_y=-0.2), Bump(crest=0.2, length=5, start=0.97), WAVY]
KINDS = {"vertical": contact_below, "tangent_plane": contact_on_tangent_plane}


def numbers(vector):
    return np.array([float(vector[k]) for k in range(3)])


def pose(road, seed, *, is_cambered=True):
    rng = np.random.default_rng(seed)
    place = rng.uniform((1.0, -2.0), (5.0, 2.0))
    yaw, camber = rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3) if is_cambered else 0.0
    axis = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    if is_cambered:
        axis = axis * math.cos(camber) + [0.0, 0.0, math.sin(camber)]
    return np.array([*place, float(road.height(*place)) + rng.uniform(0.3, 0.4)]), axis


def touch(kind, road, centre, axis):
    return KINDS[kind](road, ops.vector(*centre), ops.vector(*axis), RADIUS)


def foot_and_normal(road, centre):
    """The point below the centre, and the unit normal there."""
    slopes = [float(s) for s in road.gradient(centre[0], centre[1])]
    normal = np.array([-slopes[0], -slopes[1], 1.0])
    foot = np.array([*centre[:2], float(road.height(centre[0], centre[1]))])
    return foot, normal / np.linalg.norm(normal)


@pytest.mark.parametrize("road", ROADS, ids=lambda r: r.kind)
@pytest.mark.parametrize("seed", range(4))
def test_vertical_is_the_construction_of_the_benchmark(road, seed):
    """r = (z_C - z_Q) / e_spoke,z, with Q the foot of the perpendicular on the tangent plane."""
    centre, axis = pose(road, seed)
    foot, normal = foot_and_normal(road, centre)
    along = np.cross(axis, normal)
    along /= np.linalg.norm(along)
    spoke = np.cross(along, axis)
    perpendicular = centre - ((centre - foot) @ normal) * normal
    radius = (centre[2] - perpendicular[2]) / spoke[2]
    contact = touch("vertical", road, centre, axis)
    assert float(contact.loaded_radius) == pytest.approx(radius, abs=1e-14)
    assert numbers(contact.position) == pytest.approx(centre - radius * spoke, abs=1e-14)
    assert numbers(contact.longitudinal) == pytest.approx(along, abs=1e-14)
    assert numbers(contact.lateral) == pytest.approx(np.cross(normal, along), abs=1e-14)


@pytest.mark.parametrize("road", ROADS, ids=lambda r: r.kind)
@pytest.mark.parametrize("seed", range(4))
def test_tangent_plane_holds_its_contact_point(road, seed):
    centre, axis = pose(road, seed)
    foot, normal = foot_and_normal(road, centre)
    contact = touch("tangent_plane", road, centre, axis)
    point = numbers(contact.position)
    assert (point - foot) @ normal == pytest.approx(0.0, abs=1e-14)
    assert (point - centre) @ axis == pytest.approx(0.0, abs=1e-14)
    disc = contact_on_plane(road, ops.vector(*centre), ops.vector(*axis), RADIUS)
    assert point == pytest.approx(numbers(disc.position), abs=1e-14)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("road", ROADS, ids=lambda r: r.kind)
def test_deflection_is_vertical(kind, road):
    centre, axis = pose(road, 5)
    foot, normal = foot_and_normal(road, centre)
    expected = normal[2] * (RADIUS - (centre[2] - foot[2]))
    assert float(touch(kind, road, centre, axis).deflection) == pytest.approx(expected, abs=1e-15)


def radii(road, centre, axis):
    return [float(touch(kind, road, centre, axis).loaded_radius) for kind in KINDS]


@pytest.mark.parametrize("seed", range(4))
def test_the_rules_differ_only_for_wheels_cambered_on_slopes(seed):
    level = radii(Flat(), *pose(Flat(), seed))
    assert level[0] == pytest.approx(level[1], abs=1e-15)
    slope = Plane(slope_x=0.1, slope_y=0.0)
    centre, _ = pose(slope, seed)
    upright = np.array([0.0, 1.0, 0.0])
    straight = radii(slope, centre, upright)
    assert straight[0] == pytest.approx(straight[1], abs=1e-15)
    both = radii(slope, *pose(slope, seed))
    assert abs(both[0] - both[1]) > 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_a_wheel_that_lies_on_its_side_stays_finite(kind):
    contact = touch(kind, Flat(), np.array([0.0, 0.0, 0.1]), np.array([0.0, 0.0, 1.0]))
    assert np.all(np.isfinite(numbers(contact.position)))


def test_the_lowest_point_by_the_rules_of_chrono():
    """On level ground the depth is R cos γ - R sin² γ - h cos γ, the point R - δ down the wheel."""
    camber, height = 0.2, 0.33
    axis = ops.vector(0.0, math.cos(camber), math.sin(camber))
    touch = contact_of_lowest_point(Flat(), ops.vector(1.0, 2.0, height), axis, RADIUS)
    down = RADIUS * math.sin(camber) ** 2 + height * math.cos(camber)
    assert float(touch.deflection) == pytest.approx(RADIUS * math.cos(camber) - down, abs=1e-15)
    found = numbers(touch.position)
    assert found == pytest.approx([1.0, 2.0 + down * math.sin(camber), 0.0], abs=1e-15)


RECORDED = {  # of Chrono's sedan and truck in a turn: radius, camber, height, load over stiffness
    "sedan": (0.344, 0.030036, 0.3358871, 2190.0888 / 280835.2941),
    "truck": (0.4699, 0.05599, 0.4500956, 8085.627 / 441900.0),
}


@pytest.mark.parametrize("car", RECORDED)
def test_the_depths_of_recorded_wheels(car):
    radius, camber, height, wanted = RECORDED[car]
    axis = ops.vector(0.0, math.cos(camber), math.sin(camber))
    touch = contact_of_lowest_point(Flat(), ops.vector(0.0, 0.0, height), axis, radius)
    assert float(touch.deflection) == pytest.approx(wanted, abs=5e-6)


@pytest.mark.parametrize("road", ROADS[:2])
def test_without_camber_the_lowest_point_is_the_contact_of_the_disc(road):
    normal = np.array([-float(g) for g in road.gradient(0.0, 0.0)] + [1.0])
    axis = ops.unit(ops.cross(ops.vector(*normal), ops.vector(1.0, 0.3, 0.0)))
    centre = ops.vector(0.4, 0.7, float(road.height(0.4, 0.7)) + 0.35)
    one, other = (
        touch(road, centre, axis, RADIUS) for touch in (contact_of_lowest_point, contact_on_plane)
    )
    assert numbers(one.position) == pytest.approx(numbers(other.position), abs=1e-14)
    assert float(one.deflection) == pytest.approx(float(other.deflection), abs=1e-14)
