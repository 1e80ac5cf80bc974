"""Headings of the tests in reports of handling, with the standards that define them."""

from __future__ import annotations

STANDARDS = {
    "conditions": "ISO 15037-1:2019",
    "constant_speed": "ISO 4138:2021",
    "constant_radius": "ISO 4138:2021",
    "constant_steering": "ISO 4138:2021",
    "equal_curvature": "ISO 4138:2021",
    "slowly_increasing_steer": "FMVSS 126 S7.6, UN R140",
    "step_steer": "ISO 7401:2011",
    "single_sine": "ISO 7401:2011",
    "swept_sine": "ISO 7401:2011",
    "pulse_steer": "ISO 7401:2011",
    "weave": "ISO 13674-1:2010",
    "sine_with_dwell": "FMVSS 126 S5.2, S7.9 and S7.11, UN R140",
    "fishhook": "NHTSA, 68 FR 59250",
    "j_turn": "NHTSA",
    "braking_in_turn": "ISO 7975:2019",
    "straight_braking": "ISO 21994:2007, UN R13-H annex 3",
    "split_braking": "ISO 14512:1999",
    "split_braking_steered": "ISO 14512:1999",
    "crosswind": "ISO 12021:2010",
    "coast_down": "ISO 10521-1:2006",
    "trailer_sway": "ISO 9815:2010",
    "double_lane_change": "ISO 3888-1:2018",
    "obstacle_avoidance": "ISO 3888-2:2011",
}
"""Standards by the name of a test, with clauses where their text was at hand."""


def heading(test: str) -> str:
    """Return the heading of a test, such as "Step steer (ISO 7401)"."""
    words = test.replace("_", " ").capitalize()
    return f"{words} ({STANDARDS[test]})" if test in STANDARDS else words
