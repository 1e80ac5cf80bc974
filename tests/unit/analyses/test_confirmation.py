"""Warnings of derivatives that runs do not confirm."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.analyse.gradients.motion_slopes import EventSlope, MotionSlopes
from vehicledyn.analyses.sensitivity import confirmation
from vehicledyn.analyses.sensitivity.moving_jumps import moving_jump


@pytest.mark.parametrize(("instant", "named"), [(0.4, True), (0.9, False)])
def test_an_event_beside_the_worst_sample_is_named(monkeypatch, instant, named):
    """Differences of a channel are another ones from 0.4 s on, the worst there."""
    times = np.linspace(0.0, 1.0, 101)
    wrong = 1e-3 * np.where(times >= 0.4, 2.0 - times, 1.0)[:, None]
    monkeypatch.setattr(confirmation, "_difference", lambda _s, _c, by, _r: by[0] / 1e-3 * wrong)
    monkeypatch.setattr(confirmation, "_steps", lambda _: np.array([1e-3]))
    channel = SimpleNamespace(name="height")
    equations = SimpleNamespace(channels=[channel])
    study = SimpleNamespace(prepared=SimpleNamespace(equations=equations), channels=[0])
    events = [EventSlope("bounce", instant, np.zeros(1))]
    ones = np.ones((101, 1))
    motion = MotionSlopes(times, ones, ones[:, :, None], ones[0], ones[:1], events, "")
    (note,) = confirmation.unconfirmed(study, None, motion, [0])
    assert "'height', by up to" in note
    assert "at 0.4 s" in note
    assert ("beside event 'bounce' at 0.4 s" in note) is named


@pytest.mark.parametrize(("begin", "told"), [(0.4, True), (0.405, False)])
def test_a_jump_that_moves_between_samples_is_told(begin, told):
    """A step of 1 where a ramp begins changes its mean when it passes a sample, every 10 ms."""
    times = np.linspace(0.0, 1.0, 101)
    channel = SimpleNamespace(name="rate")

    def moved(changes):
        y = (changes["height"] * times + (times >= changes["begin"]))[:, None]
        motion = MotionSlopes(times, y, y[:, :, None][:, :, :0], y[0], y[:0], [], "")
        return SimpleNamespace(plain=lambda _: motion)

    equations = SimpleNamespace(channels=[channel])
    prepared = SimpleNamespace(equations=equations)
    study = SimpleNamespace(prepared=prepared, channels=[0], moved=moved)
    quantities = [SimpleNamespace(name=name) for name in ("height", "begin")]
    chosen = SimpleNamespace(quantities=quantities, values=np.array([2.0, begin]))
    here = moved({"height": 2.0, "begin": begin}).plain(None)
    here.slopes = np.stack([times, 0.0 * times], axis=1)[:, None]
    notes = confirmation.unconfirmed_sums(study, chosen, here, [("max", 0), ("mean", 0)])
    assert bool(notes) is told
    assert not told or "'mean(rate)'" in notes[0]


def test_jumps_that_move_with_an_event_are_reported_for_sums_and_kinks_are_not():
    """A rate that jumps by 2 at 0.405 s, which moves by 1 s: its mean by -2, which samples miss."""
    times = np.linspace(0.0, 1.0, 101)
    behind = times >= 0.405
    values = np.stack([2.0 * behind, 2.0 * behind * (times - 0.405)], axis=1)
    slopes = np.stack([0.1 + 0.0 * times, -2.0 * behind], axis=1)[:, :, None]
    events = [EventSlope("hit", 0.405, np.ones(1))]
    motion = MotionSlopes(times, values, slopes, values[0], slopes[0], events, "")
    given = np.array([0.1]), np.ones(1)
    event, part = moving_jump(motion, "mean", 0, *given)
    assert (event.name, part) == ("hit", pytest.approx(20.0))
    assert moving_jump(motion, "mean", 1, np.array([-1.2]), np.ones(1)) is None


def test_curves_and_sums_are_confirmed_by_the_same_four_runs():
    """Of 0.1 % and 0.05 % to both sides."""
    times, made = np.linspace(0.0, 1.0, 11), []
    channel = SimpleNamespace(name="height")

    def moved(changes):
        def plain(_):
            made.append(changes["height"])
            y = (changes["height"] * times)[:, None]
            return MotionSlopes(times, y, y[:, :, None][:, :, :0], y[0], y[:0], [], "")

        return SimpleNamespace(plain=plain)

    prepared = SimpleNamespace(equations=SimpleNamespace(channels=[channel]))
    study = SimpleNamespace(prepared=prepared, channels=[0], moved=moved)
    chosen = SimpleNamespace(quantities=[channel], values=np.array([2.0]))
    here = moved({"height": 2.0}).plain(None)
    here.slopes = times[:, None, None]
    made.clear()
    asked = SimpleNamespace(curves=[], figures=[("mean", "height")], others=[])
    assert confirmation.unconfirmed_of(study, chosen, here, asked) == []
    assert sorted(made) == pytest.approx([1.998, 1.999, 2.001, 2.002])
