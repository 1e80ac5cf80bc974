"""Vehicles on ramps of cant: what their wheels feel, and that nothing else does."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

WAGON = Path(__file__).parent / "data" / "wagon_on_runner.yaml"
WHEELSET = Path(__file__).parents[2] / "systems" / "curving_wheelset.yaml"
RAILS = """\
track:
  kind: layout
  gauge: 1435 mm
  inclination: 1/40
  rail: "60E1"
  segments:
"""
CURVE = """\
    - {kind: straight, length: 50 m}
    - {kind: clothoid, length: 50 m}
    - {kind: arc, length: 60 m, radius: 600 m, cant: 100 mm}
    - {kind: clothoid, length: 50 m}
    - {kind: straight, length: 50 m}
"""
RAMP = """\
    - {kind: straight, length: BEGIN}
    - {kind: ramp, length: 100 m}
    - {kind: straight, length: 60 m, cant: 150 mm}
"""
TWISTED = RAMP.replace("BEGIN", "40 m, cant: -75 mm").replace("cant: 150 mm", "cant: 75 mm")
WHEELBASE, RADIUS = 10.8, 0.46
SPRING = 2.0 * 1.5e6 * 1.0**2
TWIST = 0.15 / 1.5 / 100.0
ELASTIC = "rail_contact: {kind: elastic, youngs_modulus: 210 GPa, poissons_ratio: 0.28, damping: D}"
RIGID = "rail_contact: {kind: rigid, youngs_modulus: 210 GPa, poissons_ratio: 0.28}"
SOLVER = "duration: {} s\nsolver: {{kind: rk4, step: {} ms}}\noutput: {{interval: 5 ms}}\n"


@pytest.fixture
def run(tmp_path):
    def run_text(model, track, *, seconds, step, contact="", **parameters):
        path, output = tmp_path / "ramp.yaml", tmp_path / "ramp.h5"
        head = f"title: It runs over a ramp\nmodel: {model}\n{contact}\n"
        path.write_text(head + RAILS + track + SOLVER.format(seconds, step))
        loaded = load_scenario(path, [f"{name}={value}" for name, value in parameters.items()])
        output.unlink(missing_ok=True)
        run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)
        with open_result(output) as result:
            return result.as_frame().reset_index()

    return run_text


def test_results_do_not_depend_on_where_the_runner_is(run):
    """With a frame that has impulses, wheels on level track felt those of the runner's kink."""
    places = ("0 m", "10.8 m", "-7.1 m")
    middle, ahead, behind = (
        run(WAGON, CURVE, seconds=6.0, step=0.5, ahead=place) for place in places
    )
    settled = middle["time"] > 0.5
    for name in middle:
        if name.startswith("wheels_") and name.endswith((".Q", ".Y", ".lateral_shift")):
            reach = np.ptp(middle[name][settled])
            for other in (ahead, behind):
                assert np.abs(other[name] - middle[name])[settled].max() < 2e-4 * reach, name


def test_a_twisted_track_loads_the_wheels_as_springs_in_a_row_have_it(run):
    """Two axles, each a spring against roll, are turned against each other by the twist.

    Where the cant is nothing and only changes, springs and guiding forces turn each axle about
    its middle, and the wheel loads hold it at the arms of their contacts.
    """
    found = run(WAGON, TWISTED, seconds=3.5, step=0.5, damping="150 kN*s/m").iloc[-1]
    assert found["body.x"] + 20.0 * 3.5 + 20.0 == pytest.approx(90.0, abs=0.01)
    twist = found["front.roll"] - found["rear.roll"]
    assert twist == pytest.approx(-TWIST * WHEELBASE, rel=1e-3)
    differences, moments = [], []
    for end in ("front", "rear"):
        left, right = (f"wheels_{end}.{side}" for side in ("left", "right"))
        arm = 0.75 + 0.5 * (found[f"{left}.contact_1.place"] + found[f"{right}.contact_1.place"])
        moments.append(RADIUS * (found[f"{left}.Y"] + found[f"{right}.Y"]) / arm)
        differences.append(found[f"{left}.Q"] - found[f"{right}.Q"])
    wanted = SPRING * twist / arm + moments[0] - moments[1]
    assert differences[0] - differences[1] == pytest.approx(wanted, rel=5e-3)


@pytest.mark.parametrize("contact", ["elastic", "rigid"])
def test_wheels_that_follow_a_ramp_neither_close_nor_slide_across(contact, run):
    """The rails of a ramp rise: who takes them for level sees wheels that come out of them."""
    track, until = RAMP.replace("BEGIN", "20 m"), {"seconds": 3.0, "step": 0.25}
    if contact == "rigid":
        found = [run(WHEELSET, track, contact=RIGID, **until)]
    else:
        damped = [ELASTIC.replace("D", f"{damping} s/m") for damping in (2, 20)]
        found = [run(WHEELSET, track, contact=item, **until) for item in damped]
        approach = [f["wheels.left.contact_1.approach"].iloc[-1] for f in found]
        assert approach[1] == pytest.approx(approach[0], rel=1e-3)
    last = found[0].iloc[-1]
    assert found[0]["frame.track_roll_rate"].iloc[-1] == pytest.approx(-20.0 * TWIST, rel=2e-3)
    for side in ("left", "right"):
        creepage = last[f"wheels.{side}.contact_1.lateral_creepage"]
        assert creepage == pytest.approx(-last["wheels.angle_of_attack"], abs=2e-6)
