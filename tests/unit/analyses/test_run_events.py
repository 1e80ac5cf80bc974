"""Events of a run: written into the result file, and one of them ends the run."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.analyses.preparation.build_model
import vehicledyn.catalogue
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.multibody.model.parts import BasePart, PartEvent
from vehicledyn.results.store.reader import open_result
from vehicledyn.symbolic.ops import Scalar

SCENARIO = Path(__file__).parents[3] / "scenarios" / "iltis_ramp_steer.yaml"


@dataclass(frozen=True)
class Gate(BasePart):
    """Tells when the car has driven so far, and may end the run there."""

    at: Scalar
    terminal: bool

    def events(self, situation):
        travelled = situation.kinematics.coordinate("chassis.x") - self.at
        return (PartEvent("passed", travelled, "rising", self.terminal),)


@pytest.fixture
def gates(monkeypatch):
    built = vehicledyn.analyses.preparation.build_model.build_vehicle

    def with_gates(target):
        return built(target).with_parts(Gate("half", 1.0, False), Gate("finish", 2.0, True))

    monkeypatch.setattr(vehicledyn.analyses.preparation.build_model, "build_vehicle", with_gates)


def test_events_are_written_and_end_the_run(gates, tmp_path):
    loaded = load_scenario(SCENARIO, ("duration=1 s", "manoeuvre.rate=0.001 mm/s"))
    outcome = run_scenario(
        loaded,
        output=tmp_path / "result.h5",
        backend="interpreted",
        progress=lambda *_: None,
    )
    assert outcome.status == "ok"
    with open_result(outcome.path) as result:
        assert [event.name for event in result.events] == ["half.passed", "finish.passed"]
        times = [event.time for event in result.events]
        # The car starts at x = 0 with 20 m/s, which the wheels' first deflections disturb little.
        assert times == pytest.approx([0.05, 0.1], abs=1e-5)
        ending = f"event 'finish.passed' ended the run at t = {times[1]:.9g} s"
        assert outcome.messages[1:] == [ending]
        assert result.time[-1] == times[-1]
        assert result.channel("chassis.x").values[-1] == pytest.approx(2.0, abs=1e-9)
        assert np.all(np.diff(result.time) > 0.0)
        assert result.solver["events"] == 2
        assert result.solver["ended_by"] == "finish.passed"
        assert (result.status, result.status_message) == ("ok", ending)
