"""Loops along driven paths: closed forms, velocity ratios, singular places, dead centres."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.mechanism.driven_mechanism import mechanism
from vehicledyn.analyses.mechanism.kinematics import Request, sweep_kinematics
from vehicledyn.analyses.mechanism.mechanism_path import PathDrive, run_sweep
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.results.store.reader import open_result

SYSTEMS = Path(__file__).parents[3] / "systems"


def positions(name):
    return Positions(build_subject(load_model(str(SYSTEMS / f"{name}.yaml"))).system)


def sweep(name, drives, *, together=False, hold=()):
    place = positions(name)
    machine = mechanism(place, list(drives), hold)
    values = [PathDrive(key, tuple(map(float, items))) for key, items in drives.items()]
    return machine, run_sweep(machine, values, together=together)


def channel(machine, swept, name):
    index = [c.name for c in machine.positions.channels].index(name)
    return np.array([sample.values[index] for sample in swept.samples])


def ratio(machine, swept, name, drive=0):
    index = [c.name for c in machine.positions.channels].index(name)
    return np.array([sample.ratios[drive, index] for sample in swept.samples])


def test_slider_crank_follows_its_closed_form():
    """x = r cos φ + √(l² - r² sin²φ), and its derivative."""
    angle = np.linspace(-1.0, 7.0, 33)
    machine, found = sweep("slider_crank", {"crank.angle": angle})
    radius, rod = 0.05, 0.15
    root = np.sqrt(rod**2 - (radius * np.sin(angle)) ** 2)
    slope = -radius * np.sin(angle) - radius**2 * np.sin(angle) * np.cos(angle) / root
    position = channel(machine, found, "slider.position")
    assert position == pytest.approx(radius * np.cos(angle) + root, abs=1e-13)
    assert ratio(machine, found, "slider.position") == pytest.approx(slope, abs=1e-12)
    assert not found.singular
    assert not found.failures


def test_a_drive_may_be_what_another_drive_found():
    """The slider driven to the places that the crank brought it to turns the crank back."""
    angle = np.linspace(0.3, 2.8, 9)
    machine, found = sweep("slider_crank", {"crank.angle": angle})
    places = channel(machine, found, "slider.position")
    machine, back = sweep("slider_crank", {"slider.position": places})
    assert channel(machine, back, "crank.angle") == pytest.approx(angle, abs=1e-11)
    product = ratio(machine, back, "crank.angle") * ratio(
        *sweep("slider_crank", {"crank.angle": angle}), "slider.position"
    )
    assert product == pytest.approx(np.ones(9), rel=1e-10)


def test_parallelogram_passes_its_singular_places_straight_on():
    angle = np.radians(np.linspace(0.0, 360.0, 9))
    machine, found = sweep("parallelogram", {"first_crank.angle": angle})
    assert channel(machine, found, "second_crank.angle") == pytest.approx(angle, abs=1e-9)
    places = [finding.drives[0] for finding in found.singular]
    assert np.degrees(places) == pytest.approx([0.0, 180.0, 360.0], abs=1e-5)
    assert all("second_crank.angle" in finding.coordinates for finding in found.singular)
    turning = ratio(machine, found, "second_crank.angle")
    flat = [0, 4, 8]
    assert np.isnan(turning[flat]).all()
    assert np.delete(turning, flat) == pytest.approx(np.ones(6), abs=1e-9)


def test_singular_places_between_two_samples_are_found():
    angle = np.radians(np.linspace(20.0, 340.0, 4))
    _, found = sweep("parallelogram", {"first_crank.angle": angle})
    (finding,) = found.singular
    assert np.degrees(finding.drives[0]) == pytest.approx(180.0, abs=1e-5)
    assert "singular at first_crank.angle = 180 deg" in finding.words


def test_rocker_stops_at_its_dead_centres():
    """Crank and coupler stretched, and folded: triangles with known sides."""
    crank, coupler, rocker, ground = 0.3, 0.9, 0.7, 0.8
    machine, found = sweep("four_bar", {"rocker.angle": np.radians(np.linspace(-175, -5, 35))})

    def interior(side):
        return np.arccos((ground**2 + rocker**2 - side**2) / (2.0 * ground * rocker))

    limits = [interior(coupler + crank) - np.pi, interior(coupler - crank) - np.pi]
    ends = sorted(finding.drives[0] for finding in found.failures)
    assert ends == pytest.approx(sorted(limits), abs=1e-8)
    assert all(finding.coordinates for finding in found.failures)
    reached = channel(machine, found, "rocker.angle")
    assert len(reached) == sum(
        min(limits) < a < max(limits) for a in np.radians(np.linspace(-175, -5, 35))
    )


def test_grids_and_paths():
    heights, racks = np.linspace(0.28, 0.36, 3), np.linspace(-0.01, 0.01, 3)
    drives = {"wheel.z": heights, "rack.displacement": racks}
    grid_machine, grid = sweep("double_wishbone_suspension", drives)
    path_machine, path = sweep("double_wishbone_suspension", drives, together=True)
    assert [sample.index for sample in grid.samples] == [(i, j) for i in range(3) for j in range(3)]
    assert len(path.samples) == 3
    camber = channel(grid_machine, grid, "wheel.camber")
    along = channel(path_machine, path, "wheel.camber")
    assert camber[[0, 4, 8]] == pytest.approx(along, abs=1e-12)


def test_velocity_ratios_are_slopes():
    """Central differences of the channels themselves, with a step of 1 µm."""
    step, middle = 1e-6, 0.33
    heights = [middle - step, middle, middle + step]
    machine, found = sweep("macpherson_suspension", {"wheel.z": heights})
    for name in ("wheel.camber", "wheel.steer_angle", "wheel.half_track", "strut.length"):
        low, _, high = channel(machine, found, name)
        slope = ratio(machine, found, name)[1]
        assert slope == pytest.approx((high - low) / (2.0 * step), abs=1e-8), name


def test_held_coordinates_are_told():
    machine, found = sweep("quarter_car", {"tyre.length": [0.49, 0.51]}, hold=["body.height"])
    assert "body.height" in machine.held
    assert np.ptp(channel(machine, found, "wheel.height")) == pytest.approx(0.02, abs=1e-12)


@pytest.mark.parametrize(
    ("drives", "hold", "words"),
    [
        (["crank.angel"], [], "did you mean 'crank.angle'?"),
        (["crank.angle"], ["coupler.angel"], "did you mean 'coupler.angle'?"),
        (["crank.angle", "crank.angle"], [], "driven twice"),
        (["crank.angle", "slider.position"], [], "drive fewer channels"),
        (["crank.angle"], ["slider.position"], "hold fewer coordinates"),
    ],
)
def test_drives_that_cannot_be(drives, hold, words):
    with pytest.raises(InputError, match=words.replace("?", r"\?")):
        mechanism(positions("slider_crank"), drives, hold)


def test_what_was_reached_is_kept(tmp_path):
    path = tmp_path / "found.h5"
    wish = Request({"slider.position": "150 mm:250 mm:10"})
    model = load_model(str(SYSTEMS / "slider_crank.yaml"))
    report = sweep_kinematics(model, wish, output=path, progress=lambda *_: None)
    assert report.status == "failed"
    assert "dead centre of" in report.messages[0]
    with open_result(path) as result:
        assert not result.is_whole
        assert not result.is_timed
        assert "sample" in result.state_of_run
        reached = result.channel("slider.position").values
    assert reached == pytest.approx([0.15, 0.16, 0.17, 0.18, 0.19], abs=1e-12)


PAIR = """\
title: Two corners, one written
bodies: {}
mirror:
  - plane: y
    names: {left: right}
    bodies:
      left:
        at: [0, 0.7 m, 0.3 m]
        joints: [R3 steer, R1 lean]
        mass: 1 kg
        inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]
    sensors:
      wheel_left: {kind: wheel_angles, body: left, axis: [0, 1, 0.05], radius: 0.3 m}
"""


def test_mirrored_wheels_stand_alike(tmp_path):
    path = tmp_path / "pair.yaml"
    path.write_text(PAIR, encoding="utf-8")
    place = Positions(build_subject(load_model(str(path))).system)
    names = [c.name for c in place.channels]
    starts = {"left.steer": 0.2, "left.lean": 0.1, "right.steer": -0.2, "right.lean": -0.1}
    q = np.array([starts[c.name] for c in place.coordinates])
    seen = dict(zip(names, place.values(q), strict=True))
    for name in ("toe_angle", "camber", "half_track", "contact_x", "contact_z"):
        assert seen[f"wheel_right.{name}"] == pytest.approx(seen[f"wheel_left.{name}"], abs=1e-14)
    assert seen["wheel_right.steer_angle"] == pytest.approx(-seen["wheel_left.steer_angle"])


def test_sensors_of_forces_are_left_out(tmp_path):
    """A path without forces has no channels for them, and the report says which are missing."""
    system = tmp_path / "hoist.yaml"
    system.write_text(HOIST, encoding="utf-8")
    output = tmp_path / "hoist.h5"
    wish = Request({"drum.angle": "0:1 rad:2"})
    target = load_model(str(system))
    report = sweep_kinematics(target, wish, output=output, progress=lambda *_: None)
    note = "left out: 'bearing', 'holds', 'floor', since a motion along a path knows no forces"
    assert report.messages == [note]
    names = [c.name for c in report.channels]
    height = report.table[:, names.index("load.height")]
    assert height == pytest.approx([-1.0, -0.9, -0.8], abs=1e-12)
    assert not any(name.startswith(("bearing", "holds", "floor")) for name in names)


HOIST = """
title: A load hangs on a drum
bodies:
  drum: {joints: [R2 angle], mass: 20 kg, inertia: [0.4 kg*m^2, 0.4 kg*m^2, 0.4 kg*m^2]}
  load: {joints: [{kind: T3, name: height, start: -1 m}], mass: 50 kg}
  arm: {joints: [R2 swing], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
constraints:
  rope: {kind: rack, sliding: load.height, turning: drum.angle, radius: 0.2 m, offset: -1 m}
cuts:
  stay:
    kind: rod
    a: {body: ground, point: [0, 0, 0]}
    b: {body: arm, point: [0, 0, 0.5 m]}
    length: 0.5 m
sensors:
  bearing: {kind: reaction, body: drum, axes: parent, shows: [force]}
  holds: {kind: constraint_force, constraint: stay, body: arm}
  floor: {kind: floor, body: load}
"""
