"""Headings of the tests in reports of handling, with the standards that define them."""

from __future__ import annotations

STANDARDS = {
    "conditions": "ISO 15037-1",
    "constant_speed": "ISO 4138",
    "constant_radius": "ISO 4138",
    "constant_steering": "ISO 4138",
    "equal_curvature": "ISO 4138",
    "slowly_increasing_steer": "FMVSS 126, UN R140",
    "step_steer": "ISO 7401",
    "single_sine": "ISO 7401",
    "swept_sine": "ISO 7401",
    "pulse_steer": "ISO 7401",
    "weave": "ISO 13674-1",
    "sine_with_dwell": "FMVSS 126 S5.2 and S7.9, UN R140",
    "fishhook": "NHTSA, 68 FR 59250",
    "j_turn": "NHTSA",
    "braking_in_turn": "ISO 7975",
    "straight_braking": "ISO 21994, UN R13-H",
    "split_braking": "ISO 14512",
    "split_braking_steered": "ISO 14512",
    "crosswind": "ISO 12021",
    "coast_down": "ISO 10521-1",
    "trailer_sway": "ISO 9815",
    "double_lane_change": "ISO 3888-1",
    "obstacle_avoidance": "ISO 3888-2",
}
"""Standards by the name of a test."""


def heading(test: str) -> str:
    """Return the heading of a test, such as "Step steer (ISO 7401)"."""
    words = test.replace("_", " ").capitalize()
    return f"{words} ({STANDARDS[test]})" if test in STANDARDS else words
