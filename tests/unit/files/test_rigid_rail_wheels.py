"""Rigid contact in system files: beside elastic contact, lifted wheels, independent ones."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.base.errors import InputError
from vehicledyn.export.fmu import export_fmu
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.multibody import derive
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

FOLDER = Path(__file__).parents[3] / "systems"
WHEELSET = (FOLDER / "rail_wheelset.yaml").read_text(encoding="utf-8")
ELASTIC = "{kind: elastic, youngs_modulus: 210 GPa, poissons_ratio: 0.28, damping: 2 s/m}"
RIGID = "{kind: rigid, youngs_modulus: 210 GPa, poissons_ratio: 0.28}"
CONES = {
    "profile: S1002": "profile: 'cone:1/20'",
    'inclination: 1/40, rail: "60E1"': "inclination: 1/20, rail: 'arc:300 mm'",
}
INDEPENDENT = {
    "    spins_about: 2\n    mass: mass": "    mass: mass",
    "      - {kind: R2, name: spin, description: Rotation of the wheelset}\n": "",
    "springs:": """\
  wheel_left:
    parent: wheelset
    at: [0 m, tape_circle, 0 m]
    joints: [{kind: R2, name: spin}]
    spins_about: 2
    mass: 1 kg
    inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]
  wheel_right:
    parent: wheelset
    at: [0 m, -tape_circle, 0 m]
    joints: [{kind: R2, name: spin}]
    spins_about: 2
    mass: 1 kg
    inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]
springs:""",
    "  wheels: {body: wheelset, wheels: [left, right], radius: radius, tape_circle: tape_circle, "
    "profile: 'cone:1/20'}": """\
  right: {body: wheel_right, wheels: [right], radius: radius, tape_circle: 0, profile: 'cone:1/20'}
  left: {body: wheel_left, wheels: [left], radius: radius, tape_circle: 0, profile: 'cone:1/20'}""",
}


def changed(changes, text=WHEELSET):
    for name in ("longitudinal", "lateral", "yaw"):
        old = f"name: {name}, "
        text = text.replace(old, f"{old}role: independent, ")
    for old, new in {ELASTIC: RIGID, **changes}.items():
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.fixture
def run(tmp_path):
    def run_text(text, duration, step="0.5 ms", start=""):
        (tmp_path / "system.yaml").write_text(text, encoding="utf-8")
        scenario = tmp_path / "run.yaml"
        scenario.write_text(
            f"title: A run\nmodel: system.yaml\nduration: {duration}\n"
            f"solver: {{kind: rk4, step: {step}}}\noutput: {{interval: 2 ms}}\n{start}",
            encoding="utf-8",
        )
        outcome = run_scenario(
            load_scenario(scenario),
            output=tmp_path / "run.h5",
            backend="auto",
            progress=lambda *_: None,
        )
        with open_result(outcome.path) as result:
            columns = {name: result.channel(name).values for name in result.channels}
            events = [event.name for event in result.events]
        return outcome, columns, events

    return run_text


def test_rigid_wheelset_moves_as_the_elastic_one(run):
    """Two models of contact, of cones: after a kick the wheelset sways alike.

    The kick sets no roll rate, which the rigid wheelset has at once and the elastic one by an
    impact that takes 3 % of its speed: motions are compared over their swing.
    """
    kick = "start: static\ninitial: {wheelset.lateral_rate: 0.02 m/s}\n"
    _, rigid, _ = run(changed(CONES), "0.4 s", start=kick)
    text = changed({**CONES, RIGID: ELASTIC}).replace("lateral: 3 mm", "lateral: 0 mm")
    _, elastic, _ = run(text, "0.4 s", step="0.1 ms", start=kick)
    settled = slice(25, None)
    swings = [np.ptp(motion["wheelset.lateral"][settled]) for motion in (rigid, elastic)]
    assert swings[0] == pytest.approx(swings[1], rel=0.04)
    for name in ("wheelset.lateral", "wheelset.yaw", "wheelset.roll"):
        over = [m[name][settled] / s for m, s in zip((rigid, elastic), swings, strict=True)]
        assert np.abs(over[0] - over[1]).max() < 1e-2 * np.ptp(over[0])
    for name in ("normal_force", "rolling_radius"):
        channel = f"wheels.left.contact_1.{name}"
        assert rigid[channel][settled] == pytest.approx(elastic[channel][settled], rel=1e-3)


def test_a_wheel_that_lifts_ends_the_run_with_advice(run):
    """A growing moment about the track lifts the right wheel when it is the load times the base."""
    moment = "  load: "
    turned = f"  turning: {{coordinate: wheelset.roll, force: -2e5 N*m/s * time}}\n{moment}"
    outcome, columns, events = run(changed({**CONES, moment: turned}), "1 s")
    assert events[-1] == "wheels.right.lifts"
    assert "the right wheel lifts, which rigid contact cannot follow" in outcome.messages[-1]
    assert "take 'rail_contact: {kind: elastic}'" in outcome.messages[-1]
    assert columns["wheels.right.contact_1.normal_force"][-1] == pytest.approx(0.0, abs=1.0)
    assert outcome.status == "lifted"
    assert outcome.summary["lifted_wheel"].value == "wheels.right"
    assert "lifted at t = " in outcome.messages[-1]
    with open_result(outcome.path) as result:
        assert result.has_ended and not result.is_whole and result.status == "lifted"
        assert result.time[-1] == outcome.summary["lifted_at_time"].value


def test_independent_wheels_touch_where_those_of_a_wheelset_do(tmp_path):
    found = []
    both = r"  wheel_left.spin_rate: \1\n  wheel_right.spin_rate: \1"
    apart = re.sub("  wheelset.spin_rate: (.*)", both, changed({**CONES, **INDEPENDENT}))
    for text in (changed(CONES), apart):
        path = tmp_path / "system.yaml"
        path.write_text(text, encoding="utf-8")
        prepared = prepare(load_model(str(path)), backend="interpreted", progress=lambda *_: None)
        point = start_point(prepared, 0.0, "nominal")
        values = prepared.kernel.outputs(0.0, point.state, point.unknowns)
        names = [channel.name for channel in prepared.equations.channels]
        found.append(dict(zip(names, values, strict=True)))
    wheelset, wheels = found
    for name in ("wheelset.vertical", "wheelset.roll"):
        assert wheels[name] == pytest.approx(wheelset[name], abs=1e-11)
    for side in ("left", "right"):
        place = wheels[f"{side}.{side}.place"]
        assert place == pytest.approx(wheelset[f"wheels.{side}.place"], abs=1e-9)
        for name in ("longitudinal_creepage", "lateral_creepage", "spin_creepage"):
            expected = wheelset[f"wheels.{side}.contact_1.{name}"]
            assert wheels[f"{side}.{side}.contact_1.{name}"] == pytest.approx(expected, rel=1e-7)


def test_contacts_that_jump_are_no_fmu(tmp_path):
    path = tmp_path / "system.yaml"
    path.write_text(changed(CONES), encoding="utf-8")
    equations = derive(build_subject(load_model(str(path))).system)
    moving = tuple(replace(event, guesses=((0, 0),)) for event in equations.events)
    with pytest.raises(InputError, match=r"event 'wheels\.left\.lifts' moves a point of contact"):
        export_fmu(replace(equations, events=moving), tmp_path / "wheelset.fmu")
