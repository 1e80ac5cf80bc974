"""Time histories of the Iltis benchmark: ramp and sine steer, bump."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import drive
from reference_cases.tables import read_columns

SOURCE = "independent model in ten minimal coordinates, LSODA"
WHEELS = {"FL": "fr", "FR": "fl", "RR": "rl", "RL": "rr"}
"""The benchmark's FL and RL lie at y < 0, on the right."""


@dataclass(frozen=True)
class History:
    """A reference history and the scenario that must reproduce it; bands by column."""

    title: str
    scenario: str
    table: str
    bands: dict[str, float]


STEERING_BANDS = {
    "x": 2e-5,
    "y": 2e-5,
    "z": 2e-6,
    "yaw": 1e-6,
    "pitch": 1e-6,
    "roll": 1e-6,
    "phi": 2e-6,
    "Fz": 0.5,
    "Fy": 0.5,
}
BUMP_BANDS = {"x": 2e-4, "z": 2e-4, "pitch": 2e-4, "phi": 2e-4, "Fz": 0.5, "Fy": 0.5}
HISTORIES = {
    "ramp": History("ramp steer, 20 m/s", "iltis_ramp_steer", "iltis_ramp_20.csv", STEERING_BANDS),
    "sine": History(
        "sine steer 2 mm, 20 m/s", "iltis_sine_steer", "iltis_sine_2mm_20.csv", STEERING_BANDS
    ),
    "bump": History(
        "bump in phase, 5 m/s", "iltis_bump_in_phase", "iltis_bump_in_phase_5.csv", BUMP_BANDS
    ),
}
NAMES = {
    "x": ("position x", "m", ("x",)),
    "y": ("lateral position", "m", ("y",)),
    "z": ("height", "m", ("z",)),
    "yaw": ("yaw", "rad", ("yaw",)),
    "pitch": ("pitch", "rad", ("pitch",)),
    "roll": ("roll", "rad", ("roll",)),
    "phi": ("angles of the four leaf springs", "rad", tuple(f"phi{k}" for k in WHEELS)),
    "Fz": ("four wheel loads", "N", tuple(f"Fz_{k}" for k in WHEELS)),
    "Fy": ("four lateral tyre forces", "N", tuple(f"Fy_{k}" for k in WHEELS)),
}


def channel_of(column):
    """Return the channel that holds a column of the reference."""
    if column in ("x", "y", "z"):
        return f"chassis.{column}"
    if column in ("yaw", "pitch", "roll"):
        return f"benchmark.{column}"
    wheel = WHEELS[column[-2:]]
    return {
        "ph": f"leaf_spring_{wheel}.joint_angle",
        "Fz": f"wheel_{wheel}.tyre.normal_force",
        "Fy": f"wheel_{wheel}.tyre.lateral_force",
    }[column[:2]]


def both(name):
    """Return reference columns and computed columns of a history, and its times [s]."""
    history = HISTORIES[name]
    reference = read_columns(history.table)
    run = drive(history.scenario)
    if run.time.shape != reference["t"].shape or abs(run.time - reference["t"]).max() > 1e-9:
        raise ValueError(f"{history.scenario} has other times than {history.table}")
    columns = [c for _, _, names in NAMES.values() for c in names]
    return reference, {c: run[channel_of(c)] for c in columns}, run.time


def compare():
    """Return the comparisons, over all samples."""
    rows = []
    for name, history in HISTORIES.items():
        reference, computed, time = both(name)
        for key, band in history.bands.items():
            words, unit, columns = NAMES[key]
            largest = max(np.abs(computed[c] - reference[c]).max() for c in columns)
            values = np.concatenate([reference[c] for c in columns])
            spread = f"{len(time)} samples, {values.min():.6g} ... {values.max():.6g} {unit}"
            rows.append(
                deviation(
                    SOURCE,
                    f"{history.title}: {words}",
                    reference=spread,
                    largest=largest,
                    band=band,
                    unit=unit,
                )
            )
    note = (
        "Bands of lateral position, yaw and wheel loads, and of height and pitch over the bump: "
        "as asked of the program. The others follow them; the references have eight digits and "
        "agree with a second program within 9e-6 m and 0.08 N."
    )
    return Group("Iltis: time histories", note, tuple(rows))
