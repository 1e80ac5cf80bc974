"""The slalom: cones, clearance and speed, from the path by a geometry of its own."""

from __future__ import annotations

import numpy as np

from reference_cases.comparison import Comparison, Group, deviation, exactly
from reference_cases.motions import drive
from reference_cases.tables import read_figures

CONES = [36.0 + 18.0 * k for k in range(9)]
RADIUS = 0.15


def clearances(run):
    """Return for each cone the smallest distance of the body from it [m]; negative inside."""
    body = read_figures("iltis_outline.yaml")
    x, y, yaw = (run[f"chassis.{name}"] for name in ("x", "y", "yaw"))
    found = []
    for cone in CONES:
        along = (cone - x) * np.cos(yaw) - y * np.sin(yaw)
        across = -(cone - x) * np.sin(yaw) - y * np.cos(yaw)
        beyond = np.maximum(np.maximum(along - body["front"], body["rear"] - along), 0.0)
        beside = np.maximum(np.abs(across) - body["half_width"], 0.0)
        found.append(float(np.hypot(beyond, beside).min()) - RADIUS)
    return found


def sides(run):
    """Return on which side of each cone the car passes: 1 left, -1 right."""
    y = np.interp(CONES, run["chassis.x"], run["chassis.y"])
    return [int(side) for side in np.sign(y)]


def told(passed):
    """Return sides in words."""
    return ", ".join("left" if side > 0 else "right" for side in passed)


def compare():
    """Return the comparisons."""
    run = drive("iltis_slalom")
    gaps, speed = clearances(run), run["body.forward_speed"]
    passed = sum(gap > 0.0 for gap in gaps) if run["chassis.x"][-1] > CONES[-1] + 3.0 else 0
    wanted = told([1, -1] * 4 + [1])
    rows = (
        exactly("course", "cones left standing", 9, passed),
        exactly("course", "sides of the cones", wanted, told(sides(run))),
        Comparison(
            "course",
            "smallest clearance between body and cone",
            "> 0 m",
            f"{min(gaps):.3f} m",
            "> 0 m",
            min(gaps) > 0.0,
        ),
        deviation(
            "course",
            "forward speed",
            reference=f"{len(speed)} samples, 10 m/s",
            largest=np.abs(speed - 10.0).max(),
            band=0.1,
            unit="m/s",
        ),
    )
    note = "Nine cones at 18 m and 36 km/h, outline of the body as in its data file. Speed: 1 %."
    return Group("Iltis: slalom", note, rows)
