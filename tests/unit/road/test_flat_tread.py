"""Contact of a cylinder of real width: closed forms on planes, brute force on other ground."""

import numpy as np
import pytest

from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.raised import RaisedRoad
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.wheel.contact import contact_on_plane
from vehicledyn.road.wheel.contact_tread import Tread, contact_of_tread
from vehicledyn.symbolic import ops

RADIUS, WIDTH = 0.33, 0.24
SLOPED = Plane(slope_x=0.05, slope_y=-0.08)


class Kerb(RoadSurface):
    """Level ground to the right of y = 0, and higher to its left."""

    def height(self, x, y):
        return ops.where(y > 0.0, 0.02, 0.0)

    def gradient(self, x, y):
        return 0.0, 0.0


class Bent(RoadSurface):
    """Two cross slopes that meet at y = 0."""

    def height(self, x, y):
        return 0.03 * x - 0.1 * ops.absolute(y)

    def gradient(self, x, y):
        return 0.03, ops.where(y > 0.0, -0.1, 0.1)


def axis_of(yaw, camber):
    return np.array([-np.sin(yaw) * np.cos(camber), np.cos(yaw) * np.cos(camber), np.sin(camber)])


def found(surface, centre, axis, strips=4):
    c, a = (ops.vector(*map(ops.symbol, "xyz")) for _ in range(2))
    contact = contact_of_tread(surface, c, a, RADIUS, Tread(WIDTH, strips))
    parts = [contact.position, contact.normal, contact.deflection, contact.camber]
    parts.append(contact.loaded_radius)
    numbers = ops.numeric([c, a], ops.column(parts))(centre, axis)[:, 0]
    return numbers[:3], numbers[3:6], *numbers[6:]


@pytest.mark.parametrize("camber", [0.0, 0.02, -0.05, 0.3, -0.3])
@pytest.mark.parametrize("depth", [0.004, 0.02])
def test_the_contact_point_moves_to_the_edge_of_the_tread_as_the_wheel_leans(camber, depth):
    slope = np.tan(camber)
    centre = np.array([0.4, -1.0, (RADIUS - depth) * np.cos(camber)])
    place, normal, deflection, felt, loaded = found(Flat(), centre, axis_of(0.3, camber))
    if abs(slope) * WIDTH <= 2.0 * depth:
        mean, aside = depth, -(WIDTH**2) * slope / (12.0 * depth)
    else:
        touching = 0.5 * WIDTH + depth / abs(slope)
        mean = 0.5 * abs(slope) * touching**2 / WIDTH
        aside = -np.sign(camber) * (0.5 * WIDTH - touching / 3.0)
    assert deflection == pytest.approx(mean, rel=1e-9)
    assert felt == pytest.approx(camber, abs=1e-12)
    assert normal == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    axis = axis_of(0.3, camber)
    spoke = np.cross([np.cos(0.3), np.sin(0.3), 0.0], axis)
    wanted = centre + aside * axis - (RADIUS - depth + aside * slope) * spoke
    assert place == pytest.approx(wanted, abs=1e-9)
    assert place[2] == pytest.approx(0.0, abs=1e-9)
    assert loaded == pytest.approx(RADIUS - depth + aside * slope, abs=1e-9)


def test_without_camber_it_is_the_disc_and_strips_change_nothing_on_a_plane():
    normal = np.array([-0.05, 0.08, 1.0]) / np.sqrt(1.0 + 0.05**2 + 0.08**2)
    heading = np.array([np.cos(0.4), np.sin(0.4), 0.0])
    upright = np.cross(normal, heading)
    upright = upright / np.linalg.norm(upright)
    centre = np.array([0.2, 0.1, 0.05 * 0.2 - 0.08 * 0.1 + 0.32])
    c, a = (ops.vector(*map(ops.symbol, "xyz")) for _ in range(2))
    disc = contact_on_plane(SLOPED, c, a, RADIUS)
    values = ops.numeric([c, a], ops.column([disc.position, disc.deflection]))(centre, upright)
    place, _, deflection, _, _ = found(SLOPED, centre, upright)
    assert place == pytest.approx(values[:3, 0], abs=1e-9)
    assert deflection == pytest.approx(values[3, 0], abs=1e-12)
    uneven = RaisedRoad.model_construct(base=SLOPED, rise=0.0)
    for axis in (axis_of(0.4, 0.02), axis_of(0.4, -0.25)):
        one, many = (found(s, centre, axis, n) for s, n in ((SLOPED, 1), (uneven, 7)))
        for a_part, b_part in zip(one, many, strict=True):
            assert a_part == pytest.approx(b_part, abs=1e-9)


@pytest.mark.parametrize("strips", [8, 32])
@pytest.mark.parametrize("surface", [Kerb(), Bent()], ids=["kerb", "bend"])
def test_on_an_edge_along_the_wheel_and_where_slopes_meet_it_carries_by_strips(surface, strips):
    """Mean and centroid of max(δ, 0) over thin discs, but for the strip beside the edge.

    There the deflection runs straight over its jump, which makes half a jump over one strip.
    """
    camber, centre = 0.03, np.array([0.0, 0.0, 0.315])
    axis = axis_of(0.0, camber)
    place, _, deflection, _, _ = found(surface, centre, axis, strips)
    y = WIDTH * ((np.arange(4000) + 0.5) / 4000 - 0.5)
    foot, z = y * np.cos(camber), centre[2] + y * np.sin(camber)
    if isinstance(surface, Kerb):
        radius = (z - np.where(foot > 0.0, 0.02, 0.0)) / np.cos(camber)
    else:
        away = np.where(foot > 0.0, -0.1, 0.1)
        normal = np.stack([np.full_like(away, -0.03), -away, np.ones_like(away)])
        normal = normal / np.linalg.norm(normal, axis=0)
        along = np.cross(axis, normal, axisb=0)
        radius = (z + 0.1 * abs(foot)) * normal[2] / np.linalg.norm(along, axis=1)
    pressed = np.maximum(RADIUS - radius, 0.0)
    bound = 1.05 * abs(pressed[2000] - pressed[1999]) / (2.0 * strips)
    assert 1e-6 < bound < 2e-3
    assert deflection == pytest.approx(pressed.mean(), abs=bound)
    wanted = (pressed @ y) / pressed.sum()
    assert (place - centre) @ axis == pytest.approx(wanted, abs=bound * WIDTH / deflection)


def test_a_lifted_wheel_has_a_contact_point_and_no_load():
    place, _, deflection, _, _ = found(Flat(), np.array([0.0, 0.0, 0.5]), axis_of(0.2, 0.1))
    assert deflection < 0.0
    assert np.isfinite(place).all()
