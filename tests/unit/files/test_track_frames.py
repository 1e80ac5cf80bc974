"""Bodies that ride along a track: against closed forms, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.base.errors import InputError
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.building.rail_places import nominal_lateral
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.files.building.values import Values
from vehicledyn.files.scenario import load_scenario
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive
from vehicledyn.results.store.reader import open_result
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared import count_operations

RIDER = """\
title: A mass on springs rides along a track
parameters: {speed: 20 m/s, mass: 1000 kg, stiffness: 200 kN/m}
gravity: [0, 0, -10 m/s^2]
bodies:
  rider:
    joints: [{kind: track_frame, position: speed * time + 5 m}, T2, {kind: T3, start: 1 m}, R1]
    mass: mass
    inertia: [500 kg*m^2, 800 kg*m^2, 900 kg*m^2]
springs:
  lateral:
    coordinate: rider.y
    law: {kind: spring_damper, stiffness: stiffness, damping: 20 kN*s/m}
  vertical:
    coordinate: rider.z
    law: {kind: spring_damper, stiffness: stiffness, damping: 20 kN*s/m, free_length: 1.05 m}
  roll: {coordinate: rider.roll, law: {kind: spring_damper, stiffness: 5e5 N*m/rad,
        damping: 2e4 N*m*s/rad}}
track: {kind: straight, gauge: 1435 mm, inclination: 1/40, rail: 60E1}
"""
RIDE = """\
title: It rides through a curve
model: rider.yaml
track:
  kind: layout
  gauge: 1435 mm
  inclination: 1/40
  rail: 60E1
  segments:
    - {kind: straight, length: 30 m}
    - {kind: bloss, length: 60 m}
    - {kind: arc, length: 150 m, radius: -300 m, cant: -120 mm}
    - {kind: bloss, length: 60 m}
    - {kind: straight, length: 50 m}
duration: 11 s
solver: {kind: rk4, step: 2 ms}
output: {interval: 20 ms}
"""


DRIVEN = """\
drives: {run: {coordinate: rider.x, law: {kind: constant_rate, rate: speed, start: 5 m}}}
"""


@pytest.fixture
def write(tmp_path):
    def write_files(system=RIDER, scenario=RIDE):
        (tmp_path / "rider.yaml").write_text(system)
        path = tmp_path / "ride.yaml"
        path.write_text(scenario)
        return path

    return write_files


def refusal(path):
    with pytest.raises(InputError) as refused:
        load_scenario(path)
    return str(refused.value).replace(f"{path.parent}/", "")


def test_mass_leans_out_of_a_canted_curve_as_much_as_it_must(write):
    path = write()
    output = path.with_suffix(".h5")
    loaded = load_scenario(path)
    run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)
    lean, mass, stiffness, radius, outwards, height = math.asin(0.08), 1e3, 2e5, 300.0, 0.0, 1.0
    for _ in range(20):  # The mass runs on a circle of its own.
        own = radius - height * math.sin(lean) + outwards * math.cos(lean)
        centrifugal = (20.0 / radius) ** 2 * own
        lateral = centrifugal * math.cos(lean) - 10.0 * math.sin(lean)
        vertical = 10.0 * math.cos(lean) + centrifugal * math.sin(lean)
        outwards, height = mass * lateral / stiffness, 1.05 - mass * vertical / stiffness
    with open_result(output) as result:
        frame = result.as_frame()
    frame = frame.reset_index()
    last = frame.iloc[-1]
    assert last["rider.y"] == pytest.approx(outwards, rel=1e-5)
    assert last["rider.z"] == pytest.approx(height, rel=1e-6)
    assert last["rider.track_frame.curvature"] == pytest.approx(-1.0 / 300.0, rel=1e-9)
    assert last["rider.track_frame.position"] == pytest.approx(225.0, abs=1e-9)
    assert last["rider.track_frame.speed"] == pytest.approx(20.0, abs=1e-9)


def test_frame_on_straight_track_costs_what_a_driven_slide_costs(write):
    path = write().with_name("rider.yaml")
    counts = []
    slide = RIDER.replace("{kind: track_frame, position: speed * time + 5 m}", "T1") + DRIVEN
    for text in (RIDER, slide):
        path.write_text(text)
        model, problems = read_system(path)
        assert problems == []
        equations = derive(build_system(model))
        counts.append(count_operations(equations.rate))
    assert counts[0] <= counts[1] + 2


def test_rates_of_the_frame_are_derivatives(write):
    """Against differences of the coordinates, on a curve with cant, gradient and braking."""
    law = "position: 40 m + speed * time - 1 m/s^2 * time**2"
    curved = RIDE.partition("track:")[2].partition("duration")[0]
    curved += "  gradients: [{at: 60 m, slope: 3 %, radius: 800 m}]\n"
    text = RIDER.replace("position: speed * time + 5 m", law).partition("track: {")[0]
    path = write(f"{text}track:{curved}").with_name("rider.yaml")
    model, problems = read_system(path)
    assert problems == []
    equations = derive(build_system(model))
    start = np.array([state.start for state in equations.states])
    names = [channel.name for channel in equations.channels]
    values = np.array([e.value for e in build_system(model).table.entries])
    time = equations.time
    inputs = [time, equations.state, equations.parameter]
    output = ops.numeric(inputs, equations.output)
    step, frame = 1e-4, ("x", "y", "z", "yaw", "pitch", "roll")

    def at(instant):
        found = output(instant, start, values).ravel()
        return {name: found[names.index(name)] for name in names}

    for instant in (0.2, 1.3, 2.9, 4.0):
        before, now, after = (at(instant + k * step) for k in (-1, 0, 1))
        for name in frame:
            channel = f"rider.track_{name}"
            difference = (after[channel] - before[channel]) / (2.0 * step)
            assert now[f"{channel}_rate"] == pytest.approx(difference, abs=1e-6)
    assert now["rider.track_frame.speed"] == pytest.approx(20.0 - 2.0 * 4.0)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("T2, ", "{kind: track_frame, position: 0 m}, ", "a track frame must be the first joint"),
        ("    mass: mass\n", "    mass: mass\n    at: [1 m, 0, 0]\n", "begins on the centre line"),
        ("speed * time + 5 m", "speed", "6:44: bodies.rider.joints[0].position: this is in m/s"),
        ("springs:\n", "initial: {rider.track_x: 3 m}\nsprings:\n", "follows the track; its pos"),
        ("T2, ", "{kind: T2, name: track_y}, ", "coordinate 'rider.track_y' is defined twice"),
    ],
)
def test_wrong_uses_are_told(write, old, new, told):
    assert told in refusal(write(RIDER.replace(old, new, 1)))


def test_a_track_is_asked_for_where_there_are_rails_and_only_there(write):
    bare = RIDER.partition("track: {")[0]
    without = RIDE.partition("track:")[0] + "duration" + RIDE.partition("duration")[2]
    assert "ride.yaml:1:1: track: missing: rider.yaml runs on rails" in refusal(
        write(bare, without)
    )
    path = write(bare)
    assert load_scenario(path).written.needs_track
    model, _ = read_system(path.with_name("rider.yaml"))
    with pytest.raises(InputError, match="track: missing"):
        build_system(model)
    rigid = bare.replace("{kind: track_frame, position: speed * time + 5 m}, ", "")
    assert "ride.yaml:3:1: track: rider.yaml has nothing that runs" in refusal(write(rigid))


def test_wheels_on_rails_take_the_track_of_the_scenario(write):
    system = Path(__file__).parents[3] / "systems" / "rail_wheelset.yaml"
    path = write(system.read_text())
    assert load_scenario(path).written.needs_track


def test_wheels_that_no_frame_guides_know_where_they_start(write):
    system = Path(__file__).parents[3] / "systems" / "rail_wheelset.yaml"
    text = system.read_text().replace("rate: speed}", "rate: speed, start: 12 m}")
    text = text.replace("at: [0 m, 0 m, radius]", "at: [3 m, 0 m, radius]")
    target = build_subject(load_scenario(write(text)))
    states = {state.name: state.start for state in derive(target.system).states}
    assert states["wheels.track_position"] == pytest.approx(15.0, abs=1e-3)


@pytest.mark.parametrize(("wheel", "nominal"), [("front_large_left", 0.75), ("truck", 0.0)])
def test_shifts_of_single_wheels_count_from_where_the_file_has_them(wheel, nominal):
    system = Path(__file__).parents[3] / "systems" / "tram2000.yaml"
    model, _ = read_system(system)
    values = Values(model, RoadChoice())
    place = ops.scalar(nominal_lateral(values, wheel))
    symbols = ops.column([entry.symbol for entry in values.table.entries])
    numbers = np.array([entry.value for entry in values.table.entries])
    assert ops.numeric([symbols], place)(numbers).item() == pytest.approx(nominal)
