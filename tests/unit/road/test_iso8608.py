"""Random roads: the spectrum of their class, coherence of the tracks, the ground made of them."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import quad

from vehicledyn.road.ground.random_road import isotropic_coherence, spectrum, tracks
from vehicledyn.road.surfaces.iso8608 import CLASSES, Iso8608Road

STEP = 0.05


def spectra(seeds, **given):
    """Return frequencies, spectra of both tracks and their cross spectrum, means over seeds."""
    sums, count = 0.0, None
    for seed in range(seeds):
        records = tracks(Iso8608Road(seed=seed, length=1000.0, **given).record)[:-1]
        count = len(records)
        waves = np.fft.rfft(records, axis=0)
        right, left = waves.T
        sums = sums + np.stack([abs(right) ** 2, abs(left) ** 2, right * left.conj()])
    frequency = np.fft.rfftfreq(count, STEP)
    return frequency, sums * (2.0 * STEP / count / seeds)


@pytest.mark.parametrize("road_class", ["A", "C", "H"])
def test_every_road_has_the_spectrum_of_its_class(road_class):
    frequency, (right, left, _) = spectra(3, road_class=road_class)
    inside = (frequency >= 0.011) & (frequency <= 2.83)
    line = spectrum(CLASSES[road_class], 2.0, frequency[inside])
    for side in (right, left):
        assert side[inside] == pytest.approx(line, rel=1e-9)
    assert side[~inside].max() < 1e-20


def test_the_tracks_cohere_as_on_ground_alike_in_all_directions():
    frequency, (right, left, cross) = spectra(200, road_class="B", track=1.5)
    few = (frequency > 0.02) & (frequency < 0.5)
    found = cross[few].real / np.sqrt(right[few] * left[few])
    expected = isotropic_coherence(frequency[few], 1.5, 2.0)
    for got, want in zip(np.array_split(found, 8), np.array_split(expected, 8), strict=True):
        assert got.mean() == pytest.approx(want.mean(), abs=0.02)


@pytest.mark.parametrize("waviness", [1.5, 2.0, 3.0])
def test_the_coherence_is_the_integral_of_the_spectrum_across(waviness):
    k, distance = 2.0 * np.pi * 0.2, 1.5
    power = -0.5 * (waviness + 1.0)
    cross, _ = quad(
        lambda l: (k * k + l * l) ** power * np.cos(l * distance), 0.0, 400.0, limit=2000
    )
    own, _ = quad(lambda l: (k * k + l * l) ** power, 0.0, np.inf)
    found = isotropic_coherence(np.array([0.2]), distance, waviness)[0]
    assert found == pytest.approx(cross / own, abs=2e-4)


def test_equal_and_independent_tracks():
    equal = tracks(Iso8608Road(road_class="A", length=100.0, coherence="equal").record)
    assert equal[:, 0] == pytest.approx(equal[:, 1], abs=1e-15)
    frequency, (right, left, cross) = spectra(100, road_class="A", coherence="independent")
    inside = (frequency > 0.02) & (frequency < 2.8)
    assert abs((cross[inside] / np.sqrt(right[inside] * left[inside])).mean()) < 0.01


def test_the_ground_passes_through_the_tracks_and_is_level_outside():
    road = Iso8608Road(road_class="D", length=60.0, start=10.0, fade=5.0, seed=7)
    heights = tracks(road.record)
    for index in (200, 333, 700):
        for side, y in enumerate((-0.75, 0.75)):
            assert road.height(10.0 + STEP * index, y) == pytest.approx(heights[index, side])
    middle = 0.5 * heights[400].sum()
    assert road.height(30.0, 0.0) == pytest.approx(middle)
    assert road.height(5.0, 0.3) == 0.0
    assert road.height(90.0, -2.0) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    "bad",
    [
        {"length": 50.0},
        {"length": 50.0, "road_class": "A", "roughness": 1e-5},
        {"length": 8.0, "road_class": "A"},
        {"length": 50.0, "road_class": "K"},
    ],
)
def test_roads_without_sense_are_refused(bad):
    with pytest.raises(ValidationError):
        Iso8608Road(**bad)
