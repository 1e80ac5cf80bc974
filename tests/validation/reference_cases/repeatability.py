"""Compiled against interpreted runs, and a run against its repetition."""

from __future__ import annotations

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import SCENARIOS, drive, record
from vehicledyn.files.scenario import load_scenario

DURATION = "duration=4 s"  # past the first cones; the interpreted run takes its time
FLOOR = 1e-6
"""A channel that is zero but for rounding counts by this part of the largest of its unit."""


def largest_difference(run, other):
    """Return the largest difference of any channel, relative to its own largest value."""
    units = {c.name: c.unit for c in run.prepared.equations.channels}
    sizes = {name: np.abs(values).max() for name, values in run.channels.items()}
    scale = {u: max(sizes[n] for n in sizes if units[n] == u) for u in set(units.values())}
    worst = 0.0
    for name, values in run.channels.items():
        reach = max(sizes[name], FLOOR * scale[units[name]])
        if reach > 0.0:
            worst = max(worst, np.abs(values - other[name]).max() / reach)
    return float(worst)


def compare():
    """Return the comparisons."""
    run = drive("iltis_slalom", DURATION)
    interpreted = drive("iltis_slalom", DURATION, backend="interpreted")
    again = record(load_scenario(SCENARIOS / "iltis_slalom.yaml", (DURATION,)))
    samples = f"{len(run.channels)} channels of {len(run.time)} samples"
    rows = (
        deviation(
            "interpreted run",
            "slalom, compiled: all channels",
            reference=samples,
            largest=largest_difference(run, interpreted),
            band=1e-9,
            unit="(relative)",
        ),
        deviation(
            "the same run once more",
            "slalom: all channels",
            reference=samples,
            largest=max(np.abs(run[n] - again[n]).max() for n in run.channels),
            band=0.0,
            unit="",
        ),
    )
    note = "Differences are relative to the largest value of the channel."
    return Group("Kernels and repeated runs", note, rows)
