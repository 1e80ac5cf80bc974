"""Wheel and rail profiles and where they touch, against tables of an independent program."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.tables import read_columns, read_rows
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, find_jumps, stand
from vehicledyn.rail.profiles.named_profiles import named_profile

SOURCE = "independent scan of the gap"
BESIDE_JUMP = 0.3  # mm of shift, within which a contact may have jumped in one program only
LEAP = 2.5  # mm, between rows of the table


@lru_cache(maxsize=1)
def wheelset():
    """The wheelset of the table on its track."""
    wheel = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
    rail = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), 1.435, 0.014)
    return WheelsetOnTrack(wheel, wheel, rail, rail)


@lru_cache(maxsize=1)
def standing():
    """The wheelset at the shifts of the table, which count to the right: mirrored here."""
    shifts = read_columns("s1002_60e1_contact.csv")["y_ws_mm"]
    return tuple(stand(wheelset(), 1e-3 * shift) for shift in shifts)


def table_jumps():
    """Intervals of shift in which the contact of the table leaps [mm]."""
    table = read_columns("s1002_60e1_contact.csv")
    shift, place = table["y_ws_mm"], table["s_right"]
    usual = np.maximum(np.abs(np.diff(place, prepend=place[0]))[:-1], 0.0)
    return [
        (shift[k], shift[k + 1])
        for k in range(len(shift) - 1)
        if abs(place[k + 1] - place[k]) > LEAP + 2.0 * min(usual[k], 0.2)
    ]


def deviations():
    """Largest deviations from the table away from jumps, by quantity [mm, rad]."""
    table = read_columns("s1002_60e1_contact.csv")
    wheel = wheelset().left_wheel
    found = {
        "s_right": [1e3 * s.left.place[0] for s in standing()],
        "s_left": [1e3 * s.right.place[0] for s in standing()],
        "y_rail_right": [1e3 * s.left.y[0] for s in standing()],
        "y_rail_left": [1e3 * s.right.y[0] for s in standing()],
        "r_right": [460.0 + 1e3 * wheel.table.height(s.left.place)[0] for s in standing()],
        "r_left": [460.0 + 1e3 * wheel.table.height(s.right.place)[0] for s in standing()],
        "angle_right": [abs(np.arctan(s.left.slope[0])) for s in standing()],
        "angle_left": [abs(np.arctan(s.right.slope[0])) for s in standing()],
        "roll_rad": [s.roll for s in standing()],
        "dz_mm": [1e3 * s.height for s in standing()],
    }
    away = np.array(
        [
            all(abs(shift - 0.5 * sum(jump)) > BESIDE_JUMP for jump in table_jumps())
            for shift in table["y_ws_mm"]
        ]
    )
    return {
        key: float(np.max(np.abs(np.array(values) - table[key])[away]))
        for key, values in found.items()
    }


def jump_distance():
    """How far outside the intervals of the table's leaps this program's jumps lie [mm]."""
    jumps = [1e3 * jump.lateral for jump in find_jumps(wheelset(), standing())]
    intervals = table_jumps()
    if len(jumps) != len(intervals):
        return np.inf
    return max(
        max(low - jump, jump - high, 0.0)
        for jump, (low, high) in zip(jumps, intervals, strict=True)
    )


def profile_deviation(name):
    """Largest deviation of a profile from its table [mm]."""
    rows = [row for row in read_rows("wheel_rail_profiles.csv") if row["profile"] == name]
    y, z = (np.array([float(row[key]) for row in rows]) for key in ("y_mm", "z_mm"))
    profile = named_profile(name, "wheel" if name == "S1002" else "rail")
    return float(np.max(np.abs(1e3 * profile.height(1e-3 * y) - z)))


def compare():
    """Return the comparisons of profiles and contact geometry."""
    found = deviations()
    both = {
        key: max(found[f"{key}_right"], found[f"{key}_left"])
        for key in ("s", "y_rail", "r", "angle")
    }
    rows = [
        deviation(
            "zones and arcs of the standards", f"profile {name}", reference="table",
            largest=profile_deviation(name), band=1e-4, unit="mm",
        )
        for name in ("S1002", "60E1", "60E1_manchester")
    ]  # fmt: skip
    quantities = (
        ("contact on the wheels", both["s"], 0.02, "mm"),
        ("contact on the rails", both["y_rail"], 0.02, "mm"),
        ("rolling radii", both["r"], 2e-3, "mm"),
        ("contact angles", both["angle"], 2e-4, "rad"),
        ("roll", found["roll_rad"], 2e-6, "rad"),
        ("height of the axle", found["dz_mm"], 2e-3, "mm"),
        (
            "jumps, beyond the rows between which they are",
            jump_distance(),
            0.05,
            "mm",
        ),
    )
    rows += [
        deviation(
            SOURCE, f"S1002 on 60E1 1:40, {what}", reference="41 shifts",
            largest=size, band=band, unit=unit,
        )
        for what, size, band, unit in quantities
    ]  # fmt: skip
    note = (
        "The table steps over places by 0.005 mm. Rows within 0.3 mm of a jump are left out, where "
        "either contact may be found."
    )
    return Group("Wheel and rail profiles", note, tuple(rows))
