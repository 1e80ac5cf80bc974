"""Enveloping of roads of any kind: against obstacles, a search, and on a curved road."""

import csv
from pathlib import Path

import numpy as np
import pytest
from crg_files import crg
from pydantic import ValidationError

import vehicledyn.road
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find
from vehicledyn.road.ground.enveloping import EnvelopingCam, Tandem
from vehicledyn.road.surfaces.enveloped import Enveloped
from vehicledyn.road.surfaces.obstacles import Obstacles
from vehicledyn.road.tyres.linear import Linear
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops

assert vehicledyn.road
FOLDER = Path(__file__).parent
REFERENCE = FOLDER.parents[3] / "shared/reference/road/contact/obstacle_enveloping.csv"
RADIUS = 0.3943
LINEAR = dict.fromkeys(
    ("nominal_load", "longitudinal_stiffness", "cornering_stiffness", "friction"), 1.0
)
CAMS = {"cam_length": 0.39, "cam_height": 0.37, "cam_spacing": 0.096}


def values(road, places):
    """Return height and slopes at places of the world, shape (n, 3)."""
    x, y = ops.symbol("x"), ops.symbol("y")
    along, across = road.gradient(x, y)
    number = ops.numeric([x, y], ops.column([road.height(x, y), along, across]))
    return np.array([number(*place)[:, 0] for place in places])


def straight_crg(folder, heights, step):
    """Return an OpenCRG road, straight between cross sections, with these heights along it."""
    path = folder / "road.crg"
    path.write_bytes(crg(np.outer(heights, np.ones(3)), step=step, width=1.0))
    return find("road", "opencrg")(file=str(path), interpolation="linear")


def test_the_lift_over_even_corners_is_that_over_any_corners():
    rng = np.random.default_rng(3)
    z = rng.uniform(0.0, 0.03, size=(200, 2))
    for cam in (EnvelopingCam(0.4, 0.35, 1.6), EnvelopingCam(0.2, 0.3, 2.0)):
        found = cam.even_lift(z, 0.01)
        reach = cam.steps_to_end(0.01)
        x = 0.01 * np.arange(200)
        for column in range(2):
            wanted = cam.lift(x, z[:, column], x[reach : 200 - reach])
            assert found[:, column] == pytest.approx(wanted, abs=1e-13)


@pytest.mark.long
def test_a_cleat_of_a_measured_road_is_felt_as_an_obstacle(tmp_path):
    """A cleat with bevels whose corners are cross sections of an OpenCRG road."""
    places = 0.02 * np.arange(101)
    heights = np.interp(places, [0.9, 0.96, 1.1, 1.16], [0.0, 0.025, 0.025, 0.0])
    road = Enveloped(
        road=straight_crg(tmp_path, heights, 0.02), step=1e-4, first=0.55, last=1.5, **CAMS
    )
    obstacle = Obstacles(crest=0.025, start=0.9, length=0.26, bevel=0.06, **CAMS)
    at = [(x, 0.3) for x in np.linspace(0.7, 1.0, 31)]
    found, wanted = values(road, at), values(obstacle, at)
    assert found[:, 0] == pytest.approx(wanted[:, 0], abs=1e-5)
    assert found[:, 1] == pytest.approx(wanted[:, 1], abs=2e-4)
    assert found[:, 2] == pytest.approx(0.0, abs=1e-12)
    assert wanted[:, 0].max() > 0.02


@pytest.mark.long
@pytest.mark.skipif(not REFERENCE.is_file(), reason="the reference data are not there")
def test_steps_of_measured_roads_are_felt_as_the_reference_says(tmp_path):
    """A step rises over one millimetre before its edge, which the cams touch all the same."""
    with REFERENCE.open() as file:
        rows = list(csv.DictReader(line for line in file if line[0] != "#"))
    for name in ("circle up-step", "tandem superellipse up-step"):
        chosen = [r for r in rows if r["case"].startswith(name) and float(r["h_m"]) <= 0.025]
        crest = chosen[0]["h_m"]
        chosen = [r for r in chosen if r["h_m"] == crest]
        heights = np.where(np.arange(2001) >= 1000, float(crest), 0.0)
        order, spacing = (2.0, 0.0) if name.startswith("circle") else (1.8, 0.096)
        cams = {"cam_length": RADIUS, "cam_height": RADIUS, "cam_order": order}
        road = Enveloped(
            road=straight_crg(tmp_path, heights, 1e-3),
            step=1e-4,
            cam_spacing=spacing,
            first=1.0 + min(float(r["X_centre_m"]) for r in chosen),
            last=1.0 + max(float(r["X_centre_m"]) for r in chosen),
            **cams,
        )
        found = values(road, [(1.0 + float(r["X_centre_m"]), 0.0) for r in chosen])
        assert found[:, 0] == pytest.approx([float(r["lift_closed"]) for r in chosen], abs=1e-5)


@pytest.mark.parametrize(
    ("kind", "fields", "line"),
    [
        ("heightfield", {"file": str(FOLDER / "hill.asc")}, 2.0),
        ("mesh", {"file": str(FOLDER / "ridge.obj"), "cell": 0.25}, 0.5),
        ("sine", {"amplitude_x": 0.03, "wavelength_x": 0.9, "amplitude_y": 0.0,
                  "wavelength_y": 1.0}, 0.2),
        ("iso8608", {"road_class": "E", "length": 30.0, "start": -8.0, "fade": 2.0}, 0.75),
    ],
)  # fmt: skip
def test_other_roads_are_felt_as_a_search_finds_them(kind, fields, line):
    """The highest of z - outline over places 0.1 mm apart; two cams feel mean and difference."""
    ground = find("road", kind)(**fields)
    part = {"first": 1.1, "last": 2.3, "right": line, "left": line + 0.25, "spread": 1.0}
    road = Enveloped(road=ground, step=1e-3, **part, **CAMS)
    cam = EnvelopingCam(0.39, 0.37, 1.8)
    x, y = ops.symbol("x"), ops.symbol("y")
    height = ops.numeric([x, y], ops.column([ground.height(x, y)]))
    s = np.linspace(-0.39, 0.39, 7801)

    def lift(at):
        return (height((at + s)[None, :], np.full((1, len(s)), line))[0] - cam.outline(s)).max()

    for at in (1.2, 1.55, 1.9, 2.2):
        found = values(road, [(at, line)])[0]
        ahead, behind = lift(at + 0.048), lift(at - 0.048)
        assert found[0] == pytest.approx(0.5 * (ahead + behind), abs=1e-5)
        assert found[1] == pytest.approx((ahead - behind) / 0.096, abs=3e-4)


def test_cams_roll_along_the_line_of_a_curved_road(tmp_path):
    """A cleat across a bend of 20 m radius is felt at its place along the line, not along x."""
    places, step = 0.02 * np.arange(601), 0.02
    heights = np.interp(places, [7.0, 7.06, 7.2, 7.26], [0.0, 0.02, 0.02, 0.0])
    path = tmp_path / "bend.crg"
    path.write_bytes(crg(np.outer(heights, np.ones(3)), step=step, width=1.0, phi=places / 20.0))
    ground = find("road", "opencrg")(file=str(path), interpolation="linear")
    road = Enveloped(road=ground, step=2e-3, first=6.0, last=8.4, **CAMS)
    outline = np.array([0.0, 7.0, 7.06, 7.2, 7.26, 12.0]), np.array([0, 0, 0.02, 0.02, 0, 0])
    tandem = Tandem(EnvelopingCam(0.39, 0.37, 1.8), 0.096)
    for u in (6.9, 7.02, 7.3):
        turn = u / 20.0
        place = (20.0 * np.sin(turn), 20.0 * (1.0 - np.cos(turn)))
        height, slope = tandem.height_and_slope(*outline, u)
        found = values(road, [place])[0]
        assert found[0] == pytest.approx(height[0], abs=1e-4)
        along = found[1] * np.cos(turn) + found[2] * np.sin(turn)
        across = found[2] * np.cos(turn) - found[1] * np.sin(turn)
        assert along == pytest.approx(slope[0], abs=5e-3)
        assert across == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("road", "fields", "words"),
    [
        ("sine", {}, "has no ends of its own; give first, last, right, left"),
        ("heightfield", {"first": 90.0}, "the part of the road is empty: its data lie from"),
        ("heightfield", {"step": 1e-6}, "give a larger step"),
    ],
)
def test_a_road_without_a_part_to_roll_on_is_refused(road, fields, words):
    given = {
        "sine": {"amplitude_x": 0.0, "wavelength_x": 1.0, "amplitude_y": 0.0, "wavelength_y": 1.0},
        "heightfield": {"file": str(FOLDER / "hill.asc")},
    }[road]
    enveloped = Enveloped(road=find("road", road)(**given), **CAMS, **fields)
    with pytest.raises(InputError, match=words):
        enveloped.height(0.0, 0.0)


def test_cams_on_cams_and_places_in_the_wrong_order_are_refused():
    flat = find("road", "flat")()
    with pytest.raises(ValidationError, match="last: 1 m does not lie beyond first, 2 m"):
        Enveloped(road=flat, first=2.0, last=1.0, **CAMS)
    with pytest.raises(ValidationError, match="has cams of its own"):
        Enveloped(road=Obstacles(crest=0.02, start=1.0, **CAMS), **CAMS)


def test_a_disc_on_what_a_whole_patch_feels_is_refused():
    road = Obstacles(crest=0.02, start=1.0, **CAMS)
    given = {"body": "wheel", "spin": "spin", "tyre": Linear(**LINEAR), "surface": road}
    with pytest.raises(InputError, match="choose contact 'tangent_plane' or 'vertical'"):
        RoadWheel("wheel", radius=0.3, stiffness=2e5, **given)
    assert RoadWheel("wheel", radius=0.3, stiffness=2e5, contact="vertical", **given)
