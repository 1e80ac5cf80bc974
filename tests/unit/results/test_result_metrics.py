import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.results.metrics import (
    Extreme,
    clearance,
    distance_to_polygon,
    largest,
    peak,
    smallest,
)

BOX = np.array([[2.0, 1.0], [-2.0, 1.0], [-2.0, -1.0], [2.0, -1.0]])


def brute_force(points, corners, count=4000):
    """Distance to points laid densely along the edges, and the winding number."""
    shares = np.linspace(0.0, 1.0, count)[:, None]
    edge = np.concatenate(
        [a + shares * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    distances = np.array([np.min(np.hypot(*(edge - point).T)) for point in points])
    winding = []
    for point in points:
        angles = np.unwrap(np.arctan2(*(edge - point).T[::-1]))
        winding.append(abs(angles[-1] - angles[0]) > np.pi)
    return np.where(winding, -distances, distances)


def test_extremes_come_with_their_first_time():
    time, values = [0.0, 0.5, 1.0, 1.5], [1.0, -3.0, 2.0, -3.0]
    assert peak(time, values) == Extreme(-3.0, 0.5)
    assert largest(time, values) == Extreme(2.0, 1.0)
    assert smallest(time, values) == Extreme(-3.0, 0.5)


def test_extremes_of_nothing_and_of_nan():
    with pytest.raises(InputError, match="at least one sample"):
        peak([], [])
    found = peak([0.0, 1.0, 2.0], [5.0, np.nan, 9.0])
    assert np.isnan(found.value)
    assert found.time == 1.0


@pytest.mark.parametrize("turn", [1, -1])
def test_distance_to_a_concave_polygon(turn):
    corners = np.array([[0, 0], [4, 0], [4, 3], [2, 1], [0, 3]], dtype=float)[::turn]
    points = np.random.default_rng(1).uniform(-2.0, 6.0, size=(60, 2))
    expected = brute_force(points, corners)
    assert distance_to_polygon(points, corners) == pytest.approx(expected, abs=2e-3)


def test_distance_at_corners_edges_and_centre():
    points = [[2.0, 1.0], [0.0, 1.0], [0.0, 0.0], [5.0, 5.0], [0.0, 3.5]]
    expected = [0.0, 0.0, -1.0, 5.0, 2.5]
    assert distance_to_polygon(points, BOX) == pytest.approx(expected, abs=1e-15)


def test_clearance_of_a_turned_body():
    found = clearance(BOX, [0.0], [0.0], [np.pi / 2.0], cones=[[0.0, 3.0], [3.0, 0.0]], radius=0.25)
    assert found.distance == pytest.approx([0.75, 1.75], abs=1e-12)


def test_clearance_is_negative_where_body_and_cone_overlap():
    x = np.array([-10.0, 0.0, 10.0])
    found = clearance(BOX, x, 0.0 * x, 0.0 * x, cones=[[0.0, 1.1], [10.0, 0.5]], radius=0.2)
    assert found.distance == pytest.approx([-0.1, -0.7], abs=1e-12)
    assert found.sample.tolist() == [1, 2]


def test_clearance_equals_a_search_over_all_poses():
    random = np.random.default_rng(7)
    x, y = np.linspace(0.0, 60.0, 400), random.normal(size=400)
    heading = random.uniform(-np.pi, np.pi, size=400)
    cones = random.uniform([0.0, -8.0], [60.0, 8.0], size=(12, 2))
    outline = BOX + np.array([0.7, 0.1])
    found = clearance(outline, x, y, heading, cones=cones, radius=0.15)
    for cone, distance, sample in zip(cones, found.distance, found.sample, strict=True):
        all_poses = []
        for k in range(400):
            c, s = np.cos(heading[k]), np.sin(heading[k])
            ground = np.array([x[k], y[k]]) + outline @ np.array([[c, s], [-s, c]])
            all_poses.append(distance_to_polygon(cone[None], ground)[0] - 0.15)
        assert distance == pytest.approx(min(all_poses), abs=1e-12)
        assert sample == int(np.argmin(all_poses))


def test_clearance_passes_over_poses_that_are_not_finite():
    found = clearance(BOX, [np.nan, 0.0], [0.0, 0.0], [0.0, 0.0], cones=[[0.0, 2.0]])
    assert (found.distance[0], found.sample[0]) == (1.0, 1)
    none = clearance(BOX, [0.0], [0.0], [np.nan], cones=[[0.0, 2.0]])
    assert np.isnan(none.distance).all()


def test_clearance_needs_an_outline_and_a_pose():
    with pytest.raises(InputError, match="three corners"):
        clearance(BOX[:2], [0.0], [0.0], [0.0], cones=[[0.0, 2.0]])
    with pytest.raises(InputError, match="one pose"):
        clearance(BOX, [], [], [], cones=[[0.0, 2.0]])
