"""Profiles: pieces, standard profiles, derivatives, names."""

from itertools import pairwise

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import cone, named_profile
from vehicledyn.rail.profiles.profile import tabulated
from vehicledyn.rail.profiles.profile_pieces import Arc, Polynomial, table

STANDARD = [("S1002", "wheel"), ("60E1", "rail"), ("60E1_manchester", "rail")]


def away_from_joints(profile, count=4001):
    places = np.linspace(profile.begin + 5e-4, profile.end - 5e-4, count)
    joints = np.array([piece.end for piece in profile.pieces[:-1]])
    return places[np.abs(places[:, None] - joints).min(axis=1) > 2e-6]


@pytest.mark.parametrize(("name", "kind"), STANDARD)
def test_derivatives_are_those_of_the_height(name, kind):
    profile = named_profile(name, kind)
    places, step = away_from_joints(profile), 1e-6
    # Differences lose their digits where the curve is nearly upright.
    places = places[np.abs(profile.slope(places)) < 4.0]
    slope = (profile.height(places + step) - profile.height(places - step)) / (2.0 * step)
    bend = (profile.slope(places + step) - profile.slope(places - step)) / (2.0 * step)
    assert profile.slope(places) == pytest.approx(slope, rel=1e-5, abs=1e-7)
    _, found, second = profile.values(places)
    assert second == pytest.approx(bend, rel=1e-5, abs=1e-3)
    curvature = second / (1.0 + found**2) ** 1.5
    assert profile.curvature(places) == pytest.approx(curvature, rel=1e-12)


@pytest.mark.parametrize(("name", "kind"), STANDARD)
def test_pieces_meet(name, kind):
    """The zones of S1002 are printed to digits that leave 1.2e-4 mm between them."""
    pieces = named_profile(name, kind).pieces
    for before, after in pairwise(pieces):
        assert before.end == pytest.approx(after.begin, abs=1e-12)
        left, right = (piece.values(np.array(before.end)) for piece in (before, after))
        assert left[0] == pytest.approx(right[0], abs=1.3e-7)


def test_dimensions_of_s1002():
    """Flange height 28 mm; thickness 32.5 mm at 10 mm; qR 10.794 mm."""
    wheel = named_profile("S1002", "wheel")
    places = np.linspace(-0.06, -0.03, 30001)
    height = wheel.height(places)
    assert height.max() == pytest.approx(0.028, abs=1e-8)
    flank = places > places[np.argmax(height)]
    at_10, at_26 = (np.interp(-level, -height[flank], places[flank]) for level in (0.010, 0.026))
    assert at_10 + 0.07 == pytest.approx(0.0325, abs=2e-6)
    assert at_10 - at_26 == pytest.approx(0.010794, abs=2e-6)
    assert wheel.height(0.0) == 0.0


def test_dimensions_of_60e1():
    """Nominal width of the head 72 mm, 14.1 mm below the crown; crown of 300 mm radius."""
    rail = named_profile("60E1", "rail")
    places = np.linspace(0.03, rail.end, 20001)
    half = np.interp(0.0141, -rail.height(places), places)
    assert 2.0 * half == pytest.approx(0.071977, abs=1e-6)
    assert rail.curvature(0.004) == pytest.approx(-1.0 / 0.3, rel=1e-12)
    assert rail.curvature(0.02) == pytest.approx(-1.0 / 0.08, rel=1e-12)
    assert rail.curvature(-0.03) == pytest.approx(-1.0 / 0.013, rel=1e-12)
    assert rail.slope(0.0365) == pytest.approx(-20.0, rel=1e-9)


def test_outside_a_profile_there_is_nothing():
    wheel = named_profile("S1002", "wheel")
    assert np.isnan(wheel.height(np.array([-0.0701, 0.0601]))).all()
    assert np.isfinite(wheel.height(np.array([-0.07, 0.06]))).all()


@pytest.mark.parametrize("turn", [0.0, 0.025, -0.05])
def test_tables_follow_turned_pieces(turn):
    """Against points of the pieces turned one by one."""
    rail = named_profile("60E1", "rail")
    turned = tabulated(rail.pieces, 1e-4, turn)
    y = np.linspace(-0.035, 0.035, 2001)
    z = rail.height(y)
    c, s = np.cos(turn), np.sin(turn)
    heights, slopes, _ = turned.values(c * y - s * z)
    assert heights == pytest.approx(s * y + c * z, abs=1e-11)
    assert np.arctan(slopes) == pytest.approx(np.arctan(rail.slope(y)) + turn, abs=1e-7)
    assert turned.height(c * y - s * z) == pytest.approx(heights, abs=0.0)


def test_quintic_tables_are_exact_for_quintics():
    coefficients = (0.1, -0.3, 0.2, 0.05, -0.4, 0.7)
    line = Polynomial(-1.0, 1.0, coefficients)
    places = np.array([-1.0, -0.2, 0.3, 1.0])
    rebuilt = table(places, *line.values(places))
    fine = np.linspace(-1.0, 1.0, 101)
    for found, expected in zip(rebuilt.values(fine), line.values(fine), strict=True):
        assert found == pytest.approx(expected, abs=1e-12)


def test_curvature_may_jump_within_a_table():
    arcs = (Arc(-0.01, 0.0, (0.0, -0.1), 0.1), Arc(0.0, 0.01, (0.0, -0.02), 0.02))
    bend = tabulated(arcs, 1e-4).values(np.array([-1e-9, 1e-9]))[2]
    assert bend == pytest.approx([-10.0, -50.0], rel=1e-6)


def test_cone_and_arc():
    assert named_profile("cone:1/40", "wheel").height(0.02) == pytest.approx(-5e-4, abs=1e-15)
    for text in ("arc:300", "arc:300 mm", "arc:0.3 m"):
        assert named_profile(text, "rail").curvature(0.01) == pytest.approx(-1.0 / 0.3, rel=1e-12)
    assert named_profile("arc:-300", "wheel").curvature(0.01) == pytest.approx(1.0 / 0.3, rel=1e-12)
    assert cone(0.05, "wheel").slope(0.03) == pytest.approx(-0.05, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        ("S1003", "wheel", "did you mean 'S1002'?"),
        ("60E1", "wheel", "is the profile of a rail"),
        ("cone:steep", "wheel", "write a slope"),
        ("cone:3", "wheel", "write a slope"),
        ("arc:0", "rail", "write a radius"),
        ("arc:3 kg", "rail", "wrong unit"),
    ],
)
def test_wrong_names(text, kind, told):
    with pytest.raises(InputError, match=told):
        named_profile(text, kind)
