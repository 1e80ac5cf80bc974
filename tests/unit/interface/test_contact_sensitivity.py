"""Derivatives of the contact geometry of wheel and rail profiles."""

import math
from itertools import pairwise

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.contact.contact_conicity import conicities
from vehicledyn.analyses.contact.contact_geometry import ContactRequest, placed
from vehicledyn.analyses.contact.contact_slopes import PARAMETERS, SEEN
from vehicledyn.base.errors import AccuracyWarning, InputError
from vehicledyn.rail.geometry.wheelset_geometry import stand

ARCS = "arc:600 mm", "arc:300 mm"
PLACE = {"shift": 2e-3, "yaw": 0.01, "curvature": 1.0 / 400.0, "inclination": 0.05}
MEASURES = {"gauge": 1.435, "gauge_depth": 0.014, "back_to_back": 1.36, "flange_back": 0.07}
AT = "2 mm, rail=arc:300 mm, yaw=0.01 rad, curve_radius=400 m, inclination=0.0500417084"


def _seen(given):
    """Return radius difference, roll, places and contact angles from the geometry itself."""
    own = {k: v for k, v in given.items() if k in MEASURES or k in ("yaw", "curvature")}
    radii = given["left_radius"], given["right_radius"]
    inclination = given["inclination"]
    request = ContactRequest((ARCS[0],) * 2, (ARCS[1],) * 2, radii, inclination=inclination, **own)
    wheelset = placed(request)[0]
    found = stand(wheelset, given["shift"], given["yaw"])
    left, right = (
        wheel.radius + float(wheel.table.height(touch.place[:1])[0])
        for wheel, touch in (
            (wheelset.left_wheel, found.left),
            (wheelset.right_wheel, found.right),
        )
    )
    angles = (math.atan(touch.slope[0]) for touch in (found.left, found.right))
    return np.array([left - right, found.roll, found.left.place[0], *angles])


NAMES = "radius_difference", "roll", "left.place", "left.angle", "right.angle"


def test_no_measure_is_left_out():
    """All change at once, in a curve and with yaw; profiles are arcs, smooth everywhere."""
    given = {**PLACE, **MEASURES, "left_radius": 0.46, "right_radius": 0.46}
    given["inclination"] = math.atan(0.0500417084)
    found = vd.sensitivity(ARCS[0], [f"profiles({name}, {AT})" for name in NAMES])
    assert set(found["parameter"].values) == set(PARAMETERS)
    assert found["figure_value"].values == pytest.approx(_seen(given), rel=1e-9)
    sizes = {"yaw": 1e-3, "curvature": 1e-4, "inclination": 1e-3}
    numbers = np.random.default_rng(4).uniform(-1.0, 1.0, len(PARAMETERS))
    parts = {n: x * sizes.get(n, 1e-4) for n, x in zip(PARAMETERS, numbers, strict=True)}

    def moved(part):
        return _seen({name: value + part * parts[name] for name, value in given.items()})

    slopes = [(moved(h) - moved(-h)) / (2.0 * h) for h in (1.0, 0.5, 0.25)]
    first = [(4.0 * b - a) / 3.0 for a, b in pairwise(slopes)]
    expected = (16.0 * first[1] - first[0]) / 15.0
    rows = found["figure_slope"].values * [parts[name] for name in PARAMETERS]
    assert rows.sum(axis=1) == pytest.approx(expected, abs=1e-8 * np.abs(rows).max(), rel=1e-7)


@pytest.mark.long
def test_a_cone_keeps_its_conicity():
    """It is the slope of the cone whatever the track."""
    found = vd.sensitivity("cone:1/20", "profiles(conicity, 0.5 mm, rail=arc:300 mm)")
    assert found["figure_value"].values == pytest.approx([0.05], rel=1e-9)
    assert found["figure_slope"].values == pytest.approx(0.0, abs=1e-6)


@pytest.mark.long
def test_conicity_follows_the_gauge():
    """By differences, of wheels and rails of main lines."""
    at = "profiles(conicity, 1 mm, rail=60E1, inclination=1:20)"
    slope = vd.sensitivity("S1002", at, "gauge")["figure_slope"].values[0, 0]

    def conicity(gauge):
        request = ContactRequest(
            ("S1002",) * 2, ("60E1",) * 2, gauge=gauge, inclination=math.atan(0.05)
        )
        wheelset = placed(request)[0]
        found = conicities(wheelset, 0.0, np.array([1e-3]), 0.46, 1.5)[0]
        return float(found["conicity"][0])

    wide, near = ((conicity(1.435 + h) - conicity(1.435 - h)) / (2.0 * h) for h in (8e-5, 4e-5))
    assert slope == pytest.approx((4.0 * near - wide) / 3.0, rel=1e-7)


@pytest.mark.long
def test_jumps_have_no_derivative():
    with pytest.warns(AccuracyWarning, match="contact jumps near shifts of"):
        found = vd.sensitivity("S1002", "profiles(conicity, 0.3 mm, rail=60E1)", "gauge")
    assert np.isnan(found["figure_slope"].values).all()


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("profiles(radius_difference, 1 mm)", "*", "rail=60E1"),
        ("profiles(radius_diference, 1 mm, rail=60E1)", "*", "did you mean 'radius_difference'"),
        ("profiles(roll, 1 N, rail=60E1)", "*", "N"),
        ("profiles(roll, 1 mm, rail=60E9)", "*", "60E9"),
        ("profiles(roll, 1 mm, rail=60E1, gauge=0 mm)", "*", "above zero"),
        ("profiles(roll, 1 mm, rail=60E1, gauge=1668 mm)", "*", "gauge"),
        ("profiles(roll, 1 mm, rail=60E1, inclination=steep)", "*", "1:40"),
        ("profiles(conicity, 0 mm, rail=60E1)", "*", "above 0"),
        ("profiles(roll, 90 mm, rail=60E1)", "*", "90"),
        ("profiles(roll, 1 mm, rail=60E1)", "gouge", "did you mean 'gauge'"),
    ],
)
def test_names_are_checked(of, to, match):
    with pytest.raises(InputError, match=match):
        vd.sensitivity("S1002", of, to)


def test_every_quantity_is_asked_for():
    found = vd.sensitivity("S1002", [f"profiles({n}, 4 mm, rail=60E1)" for n in SEEN], "gauge")
    assert np.isfinite(found["figure_slope"].values).all()


def test_each_figure_has_the_values_of_its_own_place():
    """What one per cent of a shift or gauge does is of the figure's own."""
    rest = "rail=arc:300 mm"
    of = [f"profiles(roll, 1 mm:2 mm:1, {rest})", f"profiles(roll, 1 mm, {rest}, gauge=1430 mm)"]
    found = vd.sensitivity(ARCS[0], of, ["shift", "gauge"])
    places = np.array([[1e-3, 1.435], [2e-3, 1.435], [1e-3, 1.43]])
    assert found["figure_parameter_value"].values == pytest.approx(places)
    changes = 0.01 * found["figure_slope"].values * places
    assert found["figure_change_per_percent"].values == pytest.approx(changes, rel=1e-12)
    assert np.isnan(found["parameter_value"].values).all()
    assert len(set(found["figure"].values)) == len(places)
