"""The critical speed of the car with a caravan by eigenvalues and by simulation."""

from pathlib import Path

import numpy as np

import vehicledyn as vd
from reference_cases.comparison import figure

ROOT = Path(__file__).parents[3]
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


def driven(speeds, **changes):
    """Return pairs of damping ratio and frequency after a pulse [Hz], at each of the speeds."""
    named = {name.replace("__", "."): value for name, value in changes.items()}
    runs = vd.sweep(
        SCENARIO, vary={"speed": [f"{speed} m/s" for speed in speeds]},
        set={"duration": "8 s", **named}, channels=[], workers=1, lanes=1,
    )  # fmt: skip
    names = ("sway_damping_ratio", "sway_frequency")
    return list(zip(*(runs[name].values.tolist() for name in names), strict=True))


def rows():
    """Yield damping, frequency and critical speed; a pulse of 1 degree keeps the tyres linear."""
    modes = vd.modes(str(ROOT / "systems" / "car_and_caravan.yaml"), speed=SPEEDS)
    eigenvalues = [sway(modes, case) for case in range(2)]
    runs = driven(SPEEDS, manoeuvre__amplitude="1 deg")
    by_eig = [-value.real / abs(value) for value in eigenvalues]
    source = "eigenvalues of the same system"
    for speed, value, damping, run in zip(SPEEDS, eigenvalues, by_eig, runs, strict=True):
        words = f"car with caravan at {speed:g} m/s, simulated"
        yield figure(
            source, f"{words}: damping ratio of the sway",
            reference=damping, computed=run[0], band=5e-4, unit="", digits=4,
        )  # fmt: skip
        frequency = value.imag / 2.0 / np.pi
        yield figure(
            source, f"{words}: frequency of the sway",
            reference=frequency, computed=run[1], band=1e-3, unit="Hz",
        )  # fmt: skip
    wanted, got = zero_between(by_eig), zero_between([run[0] for run in runs])
    words = "car with caravan, simulated: critical speed"
    yield figure(source, words, reference=wanted, computed=got, band=0.3, unit="m/s", digits=2)
