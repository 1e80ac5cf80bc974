"""Places and windows on a wheel."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.contact.wheel_grid import COARSEST, FINEST, wheel_grid
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
from vehicledyn.rail.profiles.named_profiles import named_profile


def grid_of(profile, inclination=1 / 40, half_distance=0.75):
    wheel = MountedWheel(named_profile(profile, "wheel"), 0.46, half_distance)
    return wheel_grid(wheel, place_rail(named_profile("60E1", "rail"), inclination, 1.435, 0.014))


def test_places_follow_the_profile():
    grid = grid_of("S1002")
    assert grid.shares.sum(axis=0) == pytest.approx(np.ones(len(grid.along)), abs=1e-12)
    steps = np.hypot(np.diff(grid.place), np.diff(grid.height))
    assert np.diff(grid.along[::2]) == pytest.approx(steps, rel=2e-3)
    assert grid.width.sum() == pytest.approx(grid.along[-1], rel=0.01)
    assert steps.min() > 0.98 * FINEST and steps.max() < COARSEST
    assert np.abs(np.diff(np.log(grid.width))).max() < 0.15
    assert len(grid.place) <= 102


@pytest.mark.parametrize(("inclination", "borders"), [(1 / 40, [-25.1]), (1 / 20, [-26.1, -8.8])])
def test_windows_end_where_contact_jumps_far(inclination, borders):
    """S1002 on 60E1: jumps from -17 to -29 mm and, at 1:20, from 6 to -16 mm as well."""
    grid = grid_of("S1002", inclination)
    crossing = [
        float(np.interp(0.5, 1.0 - below, np.interp(grid.along, grid.along[::2], grid.place)))
        for below in np.cumsum(grid.shares, axis=0)[:-1]
    ]
    assert 1e3 * np.array(crossing) == pytest.approx(borders, abs=0.3)


@pytest.mark.parametrize(("attack", "windows"), [(0.0, 2), (0.012, 2), (0.045, 3)])
def test_an_angle_of_attack_makes_contact_jump_elsewhere(attack, windows):
    """From 0.015 rad on S1002 jumps from the gauge corner to the flank as well."""
    wheel = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
    rail = place_rail(named_profile("60E1", "rail"), 1 / 40, 1.435, 0.014)
    assert wheel_grid(wheel, rail, attack).shares.shape[0] == windows


def test_one_window_where_contact_moves_evenly():
    assert grid_of("cone:1/20").shares.shape[0] == 1


def test_a_wheel_beside_its_rail_is_told():
    with pytest.raises(InputError, match="at any lateral shift"):
        grid_of("S1002", half_distance=1.5)
