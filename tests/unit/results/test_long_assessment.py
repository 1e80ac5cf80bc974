"""Runs longer than a block are assessed block by block, with the figures of the whole."""

import tracemalloc
from dataclasses import asdict

import numpy as np
import pytest

from vehicledyn.results.assessment import assess as assessing
from vehicledyn.results.assessment import curve_transitions, filters, signal, sliding, stability
from vehicledyn.results.assessment import even_samples as sampling
from vehicledyn.results.assessment.assess import assess
from vehicledyn.results.assessment.even_samples import LazyChannels
from vehicledyn.results.assessment.order_statistics import percentiles

STEP = 5e-3
ROUGH = {".frequency": 0.05, ".stability": 1e-3, ".sperling": 1e-4}
"""Spectra of pieces have lines 0.05 Hz apart; Sperling's band ends abruptly."""


@pytest.fixture
def small_blocks(monkeypatch):
    for module in (assessing, curve_transitions, filters, sampling, signal, sliding, stability):
        monkeypatch.setattr(module, "BLOCK", 4096)


def ride(duration, step=STEP):
    """A wheelset and a floor over tracks with a curve of 20 s in every 100 s."""
    time = np.arange(0.0, duration, step)
    noise = np.random.default_rng(3).normal(size=(7, len(time)))
    bend = 1e-3 * np.clip(np.abs(time % 100.0 - 50.0) - 25.0, 0.0, 5.0)
    channels = {
        "front.track_position": 22.0 * time,
        "front.curvature": bend,
        "front.left.Q": 5e4 + 4e3 * np.sin(11.0 * time) + 2e3 * noise[0],
        "front.right.Q": 5e4 - 4e3 * np.sin(11.0 * time) + 2e3 * noise[1],
        "front.left.Y": 6e3 + 2e3 * np.sin(40.0 * time) + 1e3 * noise[2],
        "front.right.Y": -3e3 + 2e3 * np.sin(40.0 * time) + 1e3 * noise[3],
        "front.left.wear_number": 30.0 + np.abs(noise[4]),
        "floor.lateral": 5e2 * bend + 0.3 * noise[5],
        "floor.vertical": 0.4 * noise[6] + 0.1 * np.sin(5.0 * time),
        "floor.roll_rate": 0.02 * np.sin(0.7 * time),
    }
    units = {"track_position": "m", "curvature": "1/m", "Q": "N", "Y": "N", "wear_number": "N"}
    units |= {"lateral": "m/s^2", "vertical": "m/s^2", "roll_rate": "rad/s"}
    return time, channels, {name: units[name.rpartition(".")[2]] for name in channels}


def numbers(value, place=""):
    """Return the numbers of an assessment by where they are in it."""
    if isinstance(value, dict):
        pairs = value.items()
    elif isinstance(value, list | np.ndarray):
        pairs = enumerate(value)
    else:
        return {place: value}
    return {k: v for key, part in pairs for k, v in numbers(part, f"{place}.{key}").items()}


@pytest.mark.parametrize("section", [{}, {"begin": 31.0, "end": 205.0}], ids=["whole", "section"])
@pytest.mark.parametrize("uneven", [False, True])
def test_blocks_give_the_figures_of_the_whole(request, section, uneven):
    time, channels, units = ride(260.0)
    if uneven:  # an instant twice and a last odd step
        time = np.insert(np.append(time, time[-1] + 0.0017), 20_000, time[20_000])
        channels = {n: np.insert(np.append(c, c[-1]), 20_000, c[0]) for n, c in channels.items()}
    whole = numbers(asdict(assess(time, channels, units, **section)))
    request.getfixturevalue("small_blocks")
    found = numbers(asdict(assess(time, channels, units, **section)))
    assert found.keys() == whole.keys()
    assert any(".transitions." in place for place in found)
    for place, value in whole.items():
        scale = 1e3 if ".guiding" in place else 1.0
        rough = next((rough for word, rough in ROUGH.items() if word in place), 1e-6)
        if isinstance(value, str) or value is None:
            assert found[place] == value
        else:
            assert found[place] == pytest.approx(value, rel=rough, abs=rough * scale), place


def test_percentiles_are_those_of_numpy():
    random = np.random.default_rng(1)
    for values in (
        random.normal(size=1001),
        5e4 + 1e-7 * random.normal(size=1000),
        np.repeat([-3.0, -0.0, 0.0, 1e-300, 7.5], 40),
        np.array([-np.inf, 2.0, 4.0, 1e308]),
        np.array([2.5]),
    ):
        blocks = np.array_split(values, 7)
        wanted = [50.0, 0.15, 99.85, 0.0, 100.0, 62.5] if np.isfinite(values).all() else [100.0]
        found = percentiles(lambda parts=blocks: parts, len(values), wanted)
        assert found == pytest.approx(np.percentile(values, wanted), rel=1e-14, abs=1e-300)


def most_memory(samples):
    """Return the most memory of an assessment of so many samples that lie on a disk."""
    units = {"a.left.Q": "N", "a.left.Y": "N", "a.right.Q": "N", "a.right.Y": "N", "a.x": "m"}

    class Column:
        def __init__(self, name):
            self._name = name

        def __len__(self):
            return samples

        def __getitem__(self, part):
            time = 0.01 * np.arange(*part.indices(samples))
            own = {"time": time, "a.x": 20.0 * time, "a.left.Q": 5e4 + 0.0 * time}
            return own.get(self._name, 5e4 + 1e3 * np.sin(time))

    tracemalloc.start()
    found = assess(Column("time"), LazyChannels(units, Column), units)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(found.wheels) == 2 and found.stability
    return most


@pytest.mark.usefixtures("small_blocks")
def test_memory_does_not_grow_with_the_samples():
    assert most_memory(150_000) - most_memory(50_000) < 1.0 * 100_000  # a byte a further sample
