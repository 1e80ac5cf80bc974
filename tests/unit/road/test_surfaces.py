"""Every surface: gradient against differences, continuity, and its own shape."""

import math
from pathlib import Path

import pytest
from pydantic import ValidationError

import vehicledyn.road  # noqa: F401
from vehicledyn.base.registry import find, kinds
from vehicledyn.road.surfaces.bump import Bump
from vehicledyn.road.surfaces.surface import ground_normal
from vehicledyn.symbolic import ops

EXAMPLES = {
    "flat": {},
    "plane": {"slope_x": 0.05, "slope_y": "-8 %", "level": "20 cm"},
    "profile": {"file": str(Path(__file__).with_name("rough_road.csv")), "start": "25 cm"},
    "opencrg": {"file": str(Path(__file__).with_name("measured_road.crg"))},
    "heightfield": {
        "file": str(Path(__file__).with_name("hill.asc")),
        "x": "10 cm",
        "rise": "-5 cm",
        "scale": "110 %",
    },
    "mesh": {"file": str(Path(__file__).with_name("ridge.obj")), "cell": "0.25 m", "y": "0.1 m"},
    "obstacles": {
        "crest": "25 mm",
        "start": "1 m",
        "length": "200 mm",
        "bevel": "20 mm",
        "count": 3,
        "spacing": "2.2 m",
        "cam_length": "390 mm",
        "cam_height": "390 mm",
        "cam_order": 2,
    },
    "enveloped": {
        "road": {
            "kind": "sine",
            "amplitude_x": 0.05,
            "wavelength_x": 2,
            "amplitude_y": 0.03,
            "wavelength_y": 3,
        },
        "cam_length": "390 mm",
        "cam_height": "390 mm",
        "cam_order": 2,
        "first": -1.0,
        "last": 9.0,
        "right": -1.05,
        "left": 1.0,
    },
    "iso8608": {"road_class": "C", "length": "30 m", "start": "-8 m", "fade": "2 m", "seed": 5},
    "bump": {"crest": "200 mm", "length": 5.0, "start": 0.97, "mode": "anti_phase"},
    "sine": {"amplitude_x": 0.05, "wavelength_x": 2, "amplitude_y": 0.03, "wavelength_y": 3},
}
PLACES = [(0.3, 0.6), (1.2, -0.7), (3.47, 0.6), (5.9, -0.6), (8.0, 0.1)]


def surface(kind):
    return find("road", kind)(**EXAMPLES[kind])


def test_every_surface_has_an_example():
    assert set(kinds("road")) == set(EXAMPLES)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
@pytest.mark.parametrize("place", PLACES)
def test_gradient_is_the_derivative_of_the_height(kind, place):
    ground, x, y = surface(kind), ops.symbol("x"), ops.symbol("y")
    height = ops.column([ground.height(x, y)])
    slopes = ops.jacobian(height, ops.column([x, y]))
    stated = ops.column(list(ground.gradient(x, y)))
    derived, given = (ops.numeric([x, y], e)(*place) for e in (slopes.T, stated))
    assert given == pytest.approx(derived, abs=1e-14)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_numbers_and_symbols_agree(kind):
    ground, x, y = surface(kind), ops.symbol("x"), ops.symbol("y")
    height = ops.numeric([x, y], ops.column([ground.height(x, y)]))(1.3, -0.4)
    assert float(ground.height(1.3, -0.4)) == pytest.approx(height[0, 0], abs=1e-15)
    normal = ground_normal(ground, 1.3, -0.4)
    assert float(ops.dot(normal, normal)) == pytest.approx(1.0, abs=1e-15)
    assert float(normal[2]) > 0.0


def test_bump_has_its_crest_in_the_middle_and_ends_level():
    bump = Bump(crest=0.2, length=5.0, start=0.97)
    assert bump.height(3.47, -1.0) == pytest.approx(0.2, abs=1e-15)
    for x in (0.0, 0.97, 5.97, 100.0):
        assert bump.height(x, 1.0) == pytest.approx(0.0, abs=1e-15)
        assert bump.gradient(x, 1.0)[0] == pytest.approx(0.0, abs=1e-15)


def test_bump_in_anti_phase_is_a_hole_on_the_right():
    bump = Bump(crest=0.2, length=5.0, start=0.97, mode="anti_phase")
    assert bump.height(2.0, 0.6) == pytest.approx(-bump.height(2.0, -0.6), abs=0)
    assert bump.height(2.0, 0.6) == pytest.approx(0.1 * (1 - math.cos(2 * math.pi * 1.03 / 5)))


@pytest.mark.parametrize("bad", [{"length": 0}, {"length": "5 kg"}, {"mode": "sideways"}])
def test_bad_bump_is_refused(bad):
    with pytest.raises(ValidationError):
        Bump(**{**EXAMPLES["bump"], **bad})
