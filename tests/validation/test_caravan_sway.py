"""The critical speed of the car with a caravan by eigenvalues and by simulation."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

ROOT = Path(__file__).parents[2]
SCENARIO = ROOT / "scenarios" / "systems" / "car_and_caravan.yaml"
SPEEDS = (33.0, 35.0)


def zero_between(damping):
    """Return the speed of zero damping on the line through two values."""
    low, high = SPEEDS
    return low + (high - low) * damping[0] / (damping[0] - damping[1])


def sway(modes, case):
    """Return the eigenvalue of the slow mode with the least damping."""
    eigenvalues = np.asarray(modes["eigenvalue"])[case]
    slow = eigenvalues[(eigenvalues.imag > 2.0) & (eigenvalues.imag < 8.0)]
    return slow[np.argmax(slow.real)]


def driven(speed, **changes):
    """Return damping ratio and frequency after a pulse [Hz]."""
    named = {name.replace("__", "."): value for name, value in changes.items()}
    run = vd.simulate(SCENARIO, set={"speed": f"{speed} m/s", "duration": "8 s", **named})
    return tuple(run.summary[f"sway_{name}"].value for name in ("damping_ratio", "frequency"))


def test_simulation_and_eigenvalues_agree_on_damping_and_critical_speed():
    """A pulse of 1 degree at the steering wheel keeps the tyres linear."""
    modes = vd.modes(str(ROOT / "systems" / "car_and_caravan.yaml"), speed=SPEEDS)
    eigenvalues = [sway(modes, case) for case in range(2)]
    runs = [driven(speed, manoeuvre__amplitude="1 deg") for speed in SPEEDS]
    by_eig = [-value.real / abs(value) for value in eigenvalues]
    by_run, frequencies = zip(*runs, strict=True)
    assert by_run == pytest.approx(by_eig, abs=5e-4)
    assert frequencies == pytest.approx([v.imag / 2 / np.pi for v in eigenvalues], rel=1e-3)
    assert by_eig[0] > 0.0 > by_eig[1]
    assert zero_between(by_run) == pytest.approx(zero_between(by_eig), rel=1e-2)


def test_the_stabiliser_damps_beyond_the_critical_speed():
    """Without it the damping is negative there, see above."""
    held, _ = driven(
        SPEEDS[1],
        caravan__stabiliser__torque="250 N*m",
        manoeuvre__free_after="0.2 s",
        duration="5 s",
    )
    assert held > 0.0
