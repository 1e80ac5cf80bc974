"""A run with wheels on rails sums up its assessment; the verb does so for an old file."""

import json
import sys
from dataclasses import dataclass

import numpy as np
import pytest

from vehicledyn.analyses.preparation.system_runnable import SystemSubject
from vehicledyn.cli import main
from vehicledyn.multibody.elements.motion_sensors import Accelerometer
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.parts import BasePart, Output
from vehicledyn.multibody.model.system import System
from vehicledyn.results.store.layout import ResultHeader
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.parameters import ParameterTable

TIME = np.arange(0.0, 20.001, 5e-3)


@dataclass(frozen=True)
class Rails(BasePart):
    """Shows forces and a lateral distance in m that is no acceleration."""

    def outputs(self, situation):
        found = [Output(Channel(f"{self.name}.lateral", "m", "Shift"), 0.0 * situation.time)]
        for side in ("left", "right"):
            found += [
                Output(Channel(f"{self.name}.{side}.{force}", "N", force), 0.0 * situation.time)
                for force in ("Y", "Q", "wear_number")
            ]
        return tuple(found)


@pytest.fixture(scope="module")
def system():
    body = Body("car", "ground", joints=(Joint("T1", "car.x"),), mass=1e4)
    parts = (Rails("front"), Accelerometer("seat", "car"))
    return System("car on rails", ParameterTable(), (body,), parts=parts)


def recorded(units):
    values = {"front.left.Q": 5e4, "front.right.Q": 5e4, "front.left.Y": 4e3}
    channels = {name: np.full_like(TIME, values.get(name, 0.0)) for name in units}
    channels["car.x"] = 25.0 * TIME
    channels["seat.vertical"] = 0.5 * np.sin(2.0 * np.pi * 5.0 * TIME)
    return channels


def test_summary_of_a_run(system):
    equations = derive(system)
    subject = SystemSubject(system)
    wanted = subject.channels(equations)
    assert len(wanted) == len(set(wanted))
    assert "front.lateral" not in wanted
    units = {c.name: c.unit for c in equations.channels if c.name in wanted}
    entries = {e.name: e for e in subject.summarise(Recording(TIME, recorded(units), units))}
    assert entries["largest_track_shift"].value == pytest.approx(4e3)
    assert entries["largest_y_over_q"].value == pytest.approx(0.08)
    assert entries["seat.n_mv"].value > 1.0
    assert entries["assessment_remarks"].value == "comfort: 4 windows of 5 s; EN 12299 asks for 60"
    assert entries["car.x.largest"].value == pytest.approx(500.0)


def test_summary_of_one_sample_tells_nothing_of_it(system):
    units = {"front.left.Q": "N", "front.left.Y": "N", "car.x": "m"}
    one = {name: np.ones(1) for name in units}
    names = {e.name for e in SystemSubject(system).summarise(Recording(np.zeros(1), one, units))}
    assert names == {"car.x.smallest", "car.x.largest"}


@pytest.fixture
def call(monkeypatch, capsys):
    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["vehicledyn", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return run


def test_the_verb(call, tmp_path):
    wheels = [f"front.{side}.{force}" for side in ("left", "right") for force in ("Y", "Q")]
    units = dict.fromkeys(wheels, "N") | {"car.x": "m", "seat.vertical": "m/s^2"}
    channels = [Channel(name, unit, name) for name, unit in units.items()]
    path = tmp_path / "run.h5"
    with ResultWriter(path, channels=channels, header=ResultHeader("A ride", "car")) as writer:
        writer.append(TIME, np.stack(list(recorded(units).values()), axis=1))
    code, out, _ = call("assess", path, "--from", "5 s", "--to", "15 s", "--json")
    found = json.loads(out)
    assert code == 0
    assert (found["begin"], found["end"], found["way"]) == pytest.approx((5.0, 15.0, 250.0))
    assert len(found["comfort"][0]["continuous"]["vertical"]) == 2
    code, out, _ = call("assess", path)
    assert "N_MV of seat is left out: there is no seat.longitudinal" in out
    for arguments, words in (
        (("--from", "5 kg"), "--from 5 kg: '5 kg' has the wrong unit"),
        (("--from", "15 s", "--to", "5 s"), "nothing to assess there: the run holds 0 to 20 s"),
    ):
        code, _, err = call("assess", path, *arguments)
        assert (code, words in err) == (2, True)
