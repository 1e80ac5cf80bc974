"""Balanced starts near changes of the track are reported, and only those."""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
import vehicledyn.analyse.equilibrium
import vehicledyn.catalogue
from vehicledyn.analyses.preparation.prepare import BALANCE_TOLERANCE, equilibrium_point, prepare
from vehicledyn.analyses.preparation.validity.rounded_kinks import NOTICED
from vehicledyn.base.errors import AccuracyWarning, NumericalError
from vehicledyn.base.parameters import read_part
from vehicledyn.interface.targets import read_target
from vehicledyn.rail.track.riding_line import rounding

SEGMENTS = [
    {"kind": "straight", "length": "50 m"},
    {"kind": "clothoid", "length": "50 m"},
    {"kind": "arc", "length": "60 m", "radius": "600 m", "cant": "100 mm"},
]
RAILS = {"kind": "layout", "gauge": "1435 mm", "inclination": "1/40", "rail": "60E1"}


def test_the_rounding_of_a_kink_fades_away_within_some_metres():
    track = read_part("track", {**RAILS, "segments": SEGMENTS}).track(Path())
    sizes = rounding(track.line, 50.0 - np.array([1.0, 2.0, 3.0, 4.0, 10.0]))
    assert sizes[:3] / sizes[1:4] == pytest.approx([1 / 0.4306] * 3, rel=0.15)
    assert sizes[1] > 10.0 * NOTICED and sizes[4] < 0.1 * NOTICED


@pytest.mark.long
@pytest.mark.parametrize("place", ["0 m", "48.5 m"])
def test_a_balanced_start_near_a_kink_is_reported(place):
    changes = {
        "track": {**RAILS, "segments": SEGMENTS},
        "start": "static",
        "parameters.begin": place,
        "output.interval": "1 ms",
    }
    near = pytest.warns(AccuracyWarning, match=r"begins to change \(wheels at 48.5 m\)")
    with nullcontext() if place == "0 m" else near:
        vd.simulate("curving_wheelset", set=changes, duration="1 ms", backend="interpreted")


@pytest.mark.long
def test_equilibria_and_modes_near_a_kink_say_so_too():
    changes = {"track": {**RAILS, "segments": SEGMENTS}, "parameters.begin": "48.5 m"}
    scenario = vd.load("curving_wheelset").changed({**changes, "start": "static"})
    for analysis in (vd.equilibrium, vd.modes):
        with pytest.warns(AccuracyWarning, match=r"begins to change \(wheels at 48.5 m\)"):
            text = analysis(scenario, backend="interpreted").report.as_text()
        assert "begins to change (wheels at 48.5 m)" in text


@pytest.mark.long
@pytest.mark.parametrize(("place", "said"), [("130 m", True), ("10 m", False)])
def test_no_balance_in_a_curve_says_how_to_start_there(place, said, monkeypatch):
    def fail(*_, **__):
        raise NumericalError("no equilibrium")

    monkeypatch.setattr("vehicledyn.analyse.equilibrium.find_equilibrium", fail)
    changes = {"track": {**RAILS, "segments": SEGMENTS}, "parameters.begin": place}
    scenario = vd.load("curving_wheelset").changed({**changes, "start": "static"})
    with pytest.raises(NumericalError) as raised:
        vd.equilibrium(scenario, backend="interpreted")
    assert ("along the tangent of a curve of 600 m" in str(raised.value)) is said


@pytest.mark.long
def test_a_balance_in_a_curve_that_is_not_found_there_is_followed_from_straight_track(monkeypatch):
    """It is the one that the direct search finds, here where that does not fail."""
    search, failed = vehicledyn.analyse.equilibrium.find_equilibrium, []

    def fail_first(*arguments, time, **others):
        if not failed:
            failed.append(time)
            raise NumericalError("no equilibrium")
        return search(*arguments, time=time, **others)

    changes = {"track": {**RAILS, "segments": SEGMENTS}, "parameters.begin": "130 m"}
    scenario = vd.load("curving_wheelset").changed({**changes, "start": "static"})
    prepared = prepare(
        read_target(scenario, [], ("scenario",)), backend="interpreted", progress=lambda *_: None
    )
    direct = equilibrium_point(prepared, 0.0, "static")
    monkeypatch.setattr("vehicledyn.analyse.equilibrium.find_equilibrium", fail_first)
    led = equilibrium_point(prepared, 0.0, "static")
    assert led.state == pytest.approx(direct.state, abs=1e-8)
    assert led.residual <= BALANCE_TOLERANCE
    assert "on straight track 87 m behind it" in led.remark and not direct.remark
