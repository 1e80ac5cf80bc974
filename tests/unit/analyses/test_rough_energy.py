"""The rough balance of the energy: as good as the fine one where samples are even and close."""

import numpy as np
import pytest

from vehicledyn.analyses.preparation.energy_figures import energy_balance, rough_balance
from vehicledyn.road.manoeuvres.channel_recorder import Recording


def swing(times, *, lost=0.0):
    """One that exchanges 1 J with a spring outside, four times a second, and loses some of it."""
    energy = 0.5 * (1.0 - np.cos(8.0 * np.pi * times)) * (1.0 - lost)
    power = 4.0 * np.pi * np.sin(8.0 * np.pi * times)
    columns = {"energy.kinetic": energy, "energy.gravity": 0.0 * times, "power.forces": power}
    units = dict.fromkeys(columns, "J")
    return Recording(times, columns, units)


def test_even_samples_need_no_spline():
    """Ten samples a period, where trapezoids are off by 3 %."""
    rough = rough_balance(swing(np.linspace(0.0, 1.0, 41)))
    assert rough.part < 0.006


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_few_samples_have_a_balance(count):
    times = np.linspace(0.0, 0.02, count)
    assert rough_balance(swing(times)).error == pytest.approx(
        energy_balance(swing(times)).error, abs=0.03
    )


def test_uneven_samples_and_losses():
    times = np.linspace(0.0, 1.0, 401)
    times = np.sort(np.append(times, [0.1234, 0.5678]))
    rough, fine = (make(swing(times, lost=0.1)) for make in (rough_balance, energy_balance))
    assert rough.part == pytest.approx(fine.part, rel=1e-2)
    assert fine.part == pytest.approx(0.1, rel=1e-2)


def test_what_lies_between_samples_is_in_doubt():
    """Ten samples a period see no loss of 1 % for certain, forty do."""
    few, many = (rough_balance(swing(np.linspace(0.0, 1.0, n), lost=0.01)) for n in (41, 161))
    assert few.error < few.uncertainty + 0.004 * few.exchanged
    assert many.error > many.uncertainty + 0.004 * many.exchanged


def test_blows_shorter_than_samples_are_in_doubt():
    """A blow that lasts half a sample takes a fifth of the energy; the samples see another work."""
    times = np.linspace(0.0, 1.0, 201)
    blow = np.exp(-0.5 * ((times - 0.5) / 0.001) ** 2) * 0.2 / (0.001 * np.sqrt(2.0 * np.pi))
    energy = np.where(times < 0.5, 1.0, np.where(times > 0.5, 0.8, 0.9))
    columns = {"energy.kinetic": energy, "energy.gravity": 0.0 * times, "power.forces": -blow}
    rough = rough_balance(Recording(times, columns, dict.fromkeys(columns, "J")))
    assert rough.error > 0.1 * rough.exchanged
    assert rough.error < rough.uncertainty
