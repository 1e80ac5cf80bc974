"""Integrals of samples of functions that jump, against closed forms."""

import numpy as np
import pytest

from vehicledyn.base.numbers.jumps import jumping_integral

PLACES = np.linspace(0.0, 3.0, 301)


@pytest.mark.parametrize("uncertain", [0.0, 1.0])
@pytest.mark.parametrize(
    "jumps", [[1.2], [1.20371], [0.0149], [2.9651], [1.0, 1.043, 2.0], [0.5, 5.0], []]
)
def test_integral_of_what_jumps(jumps, uncertain):
    """A cosine that gets larger by 1, 2, ... at some places, where a sample is of either side."""
    values, exact = np.cos(2.0 * PLACES), 0.5 * np.sin(2.0 * PLACES)
    for number, jump in enumerate(jumps, 1):
        side = np.where(jump < PLACES, number, 0.0)
        values = values + np.where(np.abs(PLACES - jump) < 1e-9, uncertain * number, side)
        exact = exact + number * np.maximum(PLACES - jump, 0.0)
    for off in (0.0, 1e-3):
        found = jumping_integral(PLACES, values, jumps, exact + off * PLACES)
        assert found == pytest.approx(exact, abs=2e-6)
