"""The steps of the scenarios: halving them must not move the results."""

from __future__ import annotations

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import drive

STEERING = {"chassis.y": (1e-6, "m"), "benchmark.yaw": (1e-7, "rad")}
BUMP = {
    "chassis.z": (2e-6, "m"),
    "benchmark.pitch": (2e-7, "rad"),
    **{f"wheel_{w}.tyre.normal_force": (0.05, "N") for w in ("fl", "fr", "rl", "rr")},
}
CASES = [
    *(("iltis_ramp_steer", f"speed={v} m/s", "0.5 ms", STEERING) for v in (10, 20, 30)),
    *(("iltis_sine_steer", f"manoeuvre.amplitude={a} mm", "0.5 ms", STEERING) for a in (1, 2, 4)),
    *(("iltis_bump_in_phase", f"speed={v} m/s", "0.005 ms", BUMP) for v in (5, 10)),
    *(("iltis_bump_anti_phase", f"speed={v} m/s", "0.005 ms", BUMP) for v in (5, 10)),
]


def compare():
    """Return the change of each result when the step is halved."""
    rows = []
    for scenario, override, half, bands in CASES:
        whole = drive(scenario, override)
        halved = drive(scenario, override, f"solver.step={half}")
        for channel, (band, unit) in bands.items():
            largest = np.abs(whole[channel] - halved[channel]).max()
            value = override.partition("=")[2]
            rows.append(
                deviation(
                    f"own run with a step of {half}",
                    f"{scenario}, {value}: {channel}",
                    reference=f"{len(whole.time)} samples",
                    largest=largest,
                    band=band,
                    unit=unit,
                )
            )
    note = "Bands: a tenth of the accuracy asked of the same quantity, or less."
    return Group("Iltis: convergence with the step", note, tuple(rows))
