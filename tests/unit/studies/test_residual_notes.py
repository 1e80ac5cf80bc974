"""What residuals say of the noise given and of priors."""

import numpy as np
import pytest

from vehicledyn.analyse.identify import estimate
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.identification.experiments import SampleFit
from vehicledyn.studies.identification.identified import Unknowns
from vehicledyn.studies.identification.residual_notes import notes_on_noise, notes_on_priors

TIMES = np.linspace(0.0, 1.0, 100)
NAMES = "offset", "slope"


def identified(prior, deviation, stated=1.0, count=100):
    """Return what is sought and found of a line of 2 + 3 t, with noise of 0.1, and its fit."""
    quantities = tuple(Quantity(name, "m", name) for name in NAMES)
    low, high = np.full(2, -10.0), np.full(2, 10.0)
    priors = np.array([np.nan, prior]), np.array([np.nan, deviation])
    unknowns = Unknowns(quantities, low, high, np.zeros(2), *priors)
    times, noise = TIMES[:count], np.random.default_rng(2).normal(size=count)
    rows = np.stack([np.ones(count), times], axis=1) / (0.1 * stated)

    def residuals(x):
        missed, slopes = unknowns.prior_residuals(x)
        own = rows @ (x - [2.0, 3.0]) - noise / stated
        return np.concatenate([own, missed]), np.vstack([rows, slopes])

    n_known = int(np.isfinite(prior))
    found = estimate(residuals, start=np.zeros(2), bounds=(low, high), n_known=n_known)
    left = residuals(found.values)[0][:count]
    return unknowns, found, [("height", SampleFit(quantities[0], "t", times, left, left, left))]


@pytest.mark.parametrize(
    ("prior", "deviation", "is_named"),
    [(2.9, 0.1, False), (0.0, 0.1, True), (2.0, 1e-3, True), (2.95, 1e-6, False)],
)
def test_a_prior_that_the_data_contradict_is_named(prior, deviation, is_named):
    """Also one that is stated so sharply that the result stays at it."""
    unknowns, found, _ = identified(prior, deviation)
    notes = notes_on_priors(unknowns, found)
    assert len(notes) == is_named
    if is_named:
        assert f"prior of 'slope', {prior:g} m with a deviation of {deviation:g} m" in notes[0]


def test_the_size_of_residuals_is_that_of_the_data_alone():
    """A prior off by a hundred deviations leaves little of its own among them."""
    assert identified(np.nan, np.nan)[1].data_variance == pytest.approx(1.0, abs=0.3)
    _, found, _ = identified(0.0, 0.03)
    expected = found.variance * (100 + 1 - 2)
    assert found.data_variance < 0.5 * expected


@pytest.mark.parametrize(
    ("stated", "count", "words"),
    [(1.0, 100, ""), (0.2, 100, "larger than"), (10.0, 100, "smaller than"), (0.8, 5, "")],
)
def test_residuals_that_the_noise_does_not_explain_are_named(stated, count, words):
    _, found, fits = identified(np.nan, np.nan, stated, count)
    notes = notes_on_noise(fits, found)
    assert len(notes) == bool(words)
    assert all(f"{words} the noise given: 'height'" in note for note in notes)
