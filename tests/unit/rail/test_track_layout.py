"""Layouts of tracks against closed forms, and their tables against the layouts."""

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from scipy.special import fresnel

from vehicledyn.rail.track.alignment import Alignment
from vehicledyn.rail.track.pieces import Grade, TrackPiece
from vehicledyn.rail.track.track import Track
from vehicledyn.rail.track.track_tables import WANTED_ERROR, centre_line
from vehicledyn.rail.track.transition_shapes import SHAPES
from vehicledyn.symbolic import ops

BASE = 1.5


def bend(length, radius, cant=0.0):
    return TrackPiece(length, (1.0 / radius,) * 2, (cant, cant))


def change(length, before, after, shape="linear", cant=(0.0, 0.0)):
    return TrackPiece(length, (before, after), cant, shape=shape)


def frames(line, places):
    s = ops.symbol("s")
    frame = line.frame(s)
    function = ca.Function("f", [s], [ca.densify(frame.position), ca.densify(frame.rotation)])
    found = [function(place) for place in places]
    return np.array([np.array(p).ravel() for p, _ in found]), np.array([r for _, r in found])


@pytest.mark.parametrize("radius", [300.0, -45.0])
def test_clothoid_is_that_of_the_fresnel_integrals(radius):
    length, start = 60.0, 17.3
    alignment = Alignment(
        [TrackPiece(start), change(length, 0.0, 1.0 / radius), TrackPiece(9.0)], BASE
    )
    line, _ = centre_line(alignment)
    along = np.linspace(0.0, length, 41)
    scale = np.sqrt(np.pi * abs(radius) * length)
    sine, cosine = fresnel(along / scale)
    places, turns = frames(line, start + along)
    assert places[:, 0] == pytest.approx(start + scale * cosine, abs=WANTED_ERROR)
    assert places[:, 1] == pytest.approx(np.sign(radius) * scale * sine, abs=WANTED_ERROR)
    heading = along**2 / (2.0 * radius * length)
    assert np.arctan2(turns[:, 1, 0], turns[:, 0, 0]) == pytest.approx(heading, abs=1e-8)


def test_graded_and_canted_arc_is_a_helix():
    radius, cant, slope = 200.0, 0.15, 0.03
    line, _ = centre_line(Alignment([bend(400.0, radius, cant)], BASE, [Grade(0.0, slope)]))
    along = np.linspace(1.0, 399.0, 23)
    places, turns = frames(line, along)
    angle, lean = along / radius, np.arcsin(cant / BASE)
    helix = np.stack([radius * np.sin(angle), radius * (1.0 - np.cos(angle)), slope * along], 1)
    assert places == pytest.approx(helix, abs=WANTED_ERROR)
    climb = np.arctan(slope)
    across = np.stack(
        [
            -np.sin(angle) * np.cos(lean) + np.cos(angle) * np.sin(climb) * np.sin(lean),
            np.cos(angle) * np.cos(lean) + np.sin(angle) * np.sin(climb) * np.sin(lean),
            -np.cos(climb) * np.sin(lean) + 0.0 * angle,
        ],
        1,
    )
    assert turns[:, :, 1] == pytest.approx(across, abs=1e-8)
    s = ops.symbol("s")
    frame = line.frame(s)
    turning, stretch = ca.Function("t", [s], [ops.norm(frame.turning), frame.stretch])(50.0)
    assert float(turning) == pytest.approx(1.0 / radius, rel=1e-9)
    assert float(stretch) == pytest.approx(np.hypot(1.0, slope), abs=1e-12)


def test_oval_closes():
    turn = np.pi * 250.0 - 40.0  # Each transition turns as much as half its length of the arc.
    half = [
        TrackPiece(123.456),
        change(40.0, 0.0, 1 / 250.0, "bloss", (0.0, 0.1)),
        bend(turn, 250.0, 0.1),
        change(40.0, 1 / 250.0, 0.0, "bloss", (0.1, 0.0)),
    ]
    line, _ = centre_line(Alignment([*half, *half], BASE))
    (end,), (turned,) = frames(line, [line.length])
    assert end == pytest.approx(0.0, abs=1e-9)
    assert turned == pytest.approx(np.eye(3), abs=1e-12)


def test_reverse_curve_ends_parallel_and_its_low_rail_stays_low():
    r, cant = 190.0, 0.11
    curve = [
        change(33.3, 0.0, 1 / r, "klein", (0.0, cant)),
        bend(20.0, r, cant),
        change(66.6, 1 / r, -1 / r, "cosine", (cant, -cant)),
        bend(20.0, -r, -cant),
        change(33.3, -1 / r, 0.0, "klein", (-cant, 0.0)),
    ]
    alignment = Alignment(curve, BASE, cant_about="low_rail")
    line, _ = centre_line(alignment)
    assert line.error <= WANTED_ERROR
    places, turns = frames(line, np.linspace(0.0, alignment.length, 57))
    assert turns[-1] == pytest.approx(np.eye(3), abs=1e-10)
    middle = 0.5 * places[-1]  # Equal curves to the left and right: turned about the middle.
    assert places[::-1, :2] == pytest.approx(2.0 * middle[:2] - places[:, :2], abs=1e-7)
    left = places + 0.5 * BASE * turns[:, :, 1]
    right = places - 0.5 * BASE * turns[:, :, 1]
    climb = np.abs(alignment.gradient(np.linspace(0.0, alignment.length, 999))).max()
    tilted = 0.25 * cant * climb**2 + 1e-8  # The frame leans across a line that climbs.
    assert np.minimum(left[:, 2], right[:, 2]) == pytest.approx(0.0, abs=tilted)
    assert np.abs(left - right)[:, 2].max() == pytest.approx(cant, abs=2e-8)


def test_cubic_parabola_has_its_plan():
    radius, length = 120.0, 50.0
    pieces = [change(length, 0.0, 1 / radius, "cubic_parabola"), TrackPiece(1.0)]
    line, _ = centre_line(Alignment(pieces, BASE))
    places, _ = frames(line, np.linspace(0.0, length, 21))
    x, y = places[:, 0], places[:, 1]
    assert y == pytest.approx(x**3 / (6.0 * radius * x[-1]), abs=WANTED_ERROR)
    mirrored = [TrackPiece(1.0), change(length, 1 / radius, 0.0, "cubic_parabola")]
    back = Alignment(mirrored, BASE).heading(np.array([1.0 + length]))
    assert back[0] == pytest.approx(np.arctan(0.5 * x[-1] / radius), abs=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_shape_is_the_derivative_of_what_it_sweeps(name):
    shape, u, step = SHAPES[name], np.linspace(0.1, 0.9, 9), 1e-6
    assert shape.share(np.array([0.0, 1.0])) == pytest.approx([0.0, 1.0], abs=1e-15)
    assert shape.swept(np.array([0.0, 1.0])) == pytest.approx([0.0, 0.5], abs=1e-15)
    for function, derivative in ((shape.swept, shape.share), (shape.share, shape.slope)):
        found = (function(u + step) - function(u - step)) / (2.0 * step)
        assert found == pytest.approx(derivative(u), abs=1e-9)


@pytest.mark.parametrize("lengths", [(20.0, 50.0, 30.0), (np.pi * 7, 13.3333, 0.017)])
def test_tables_reach_the_error_they_state(lengths):
    """Wherever the kinks lie, with curvature that jumps; and rotation fits the plan."""
    pieces = [
        TrackPiece(lengths[0]),
        bend(lengths[1], 17.0),
        bend(lengths[2], -400.0),
        TrackPiece(5.0),
    ]
    alignment = Alignment(pieces, BASE, [Grade(12.0, 0.05, 300.0)])
    line, _ = centre_line(alignment)
    assert line.error <= WANTED_ERROR
    kinks = alignment.kinks
    generator = np.random.default_rng(3)
    probes = np.sort([*generator.uniform(-3.0, alignment.length + 3.0, 200), *kinks + 1e-9])
    places, turns = frames(line, probes)
    exact = alignment.advance(np.zeros(1), np.zeros(1))
    for k, s in enumerate(probes):
        ends = np.array([0.0, *kinks[(kinks > 0.0) & (kinks < s)], s])
        ends = np.unique(np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(ends)]))
        exact = alignment.advance(ends[:-1], ends[1:]).sum(axis=1) if s > 0.0 else [s, 0.0]
        assert places[k, :2] == pytest.approx(exact, abs=2.0 * WANTED_ERROR)
    assert places[:, 2] == pytest.approx(alignment.height(probes), abs=WANTED_ERROR)
    heading = alignment.heading(probes)
    assert np.arctan2(turns[:, 1, 0], turns[:, 0, 0]) == pytest.approx(heading, abs=2e-8)


def test_error_of_one_step_of_newton_is_that_of_its_docstring():
    radius, s = 100.0, ops.symbol("s")
    line, _ = centre_line(Alignment([bend(300.0, radius)], BASE))
    track = Track(1.435, 0.014, 0.025, "60E1", line)
    frame = track.frame(s)
    point = frame.position + frame.rotation @ ops.vector(0.0, 1.5, 0.0)
    found = ca.Function("s", [s], [track.locate(point, s + 2.0) - s])
    assert float(found(150.0)) == pytest.approx(-(2.0**3) / (3.0 * radius**2), rel=1e-2)
