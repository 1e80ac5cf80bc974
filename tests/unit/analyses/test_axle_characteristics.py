"""Roll centre and motion ratio of planar suspensions against their closed geometry."""

import numpy as np
import pytest

import vehicledyn as vd

SWING = """
title: A wheel on a swing axle
parameters:
  pivot: [0 mm, 200 mm, 250 mm]
  wheel: {centre: [0 mm, 750 mm, 300 mm], radius: 300 mm}
  seat: {lower: [0 mm, 500 mm, 280 mm], upper: [0 mm, 450 mm, 700 mm]}
bodies:
  arm: {at: pivot, joints: [R1 angle], mass: 30 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
links:
  spring:
    a: {body: ground, point: seat.upper}
    b: {body: arm, point: seat.lower - pivot}
    law: {kind: spring_damper, stiffness: 20 kN/m, damping: 0 N*s/m, free_length: 500 mm}
sensors:
  wheel:
    kind: wheel_angles
    body: arm
    centre: wheel.centre - pivot
    axis: [0, 1, 0]
    radius: wheel.radius
"""

WISHBONES = {
    "lower": {"front": (0.25, 0.40, 0.22), "rear": (-0.25, 0.40, 0.22), "ball": (0.0, 0.90, 0.20)},
    "upper": {"front": (0.25, 0.45, 0.48), "rear": (-0.25, 0.45, 0.48), "ball": (0.0, 0.80, 0.50)},
}
"""Wishbones whose axes lie along x, with both ball joints above the contact point: planar."""


def turned(point, pivot, angle):
    """Return a point (y, z) turned about a pivot, from y towards z."""
    c, s = np.cos(angle), np.sin(angle)
    y, z = np.subtract(point, pivot)
    return np.array([pivot[0] + c * y - s * z, pivot[1] + s * y + c * z])


@pytest.fixture
def swing(tmp_path):
    path = tmp_path / "swing.yaml"
    path.write_text(SWING, encoding="utf-8")
    return vd.kinematics(path, {"arm.angle": ("-4 deg", "4 deg", 8)})


def test_roll_centre_of_a_swing_axle_is_on_the_line_through_its_pivot(swing):
    """The carrier turns about the pivot P; contact point C: h = -y_C (z_P - z_C)/(y_P - y_C)."""
    pivot = np.array([0.2, 0.25])
    wanted = []
    for angle in np.radians(np.linspace(-4.0, 4.0, 9)):
        centre = turned((0.75, 0.3), pivot, angle)
        y, z = centre + 0.3 * np.array([np.sin(angle), -np.cos(angle)])
        wanted.append(-y * (pivot[1] - z) / (pivot[0] - y))
    assert swing["roll_centre.arm.angle.wheel"].values == pytest.approx(wanted, rel=1e-12)


def test_motion_ratio_of_a_swing_axle_is_that_of_its_levers(swing):
    """Compression by the lever of the spring about the pivot, travel by that of the wheel."""
    pivot, top = np.array([0.2, 0.25]), np.array([0.45, 0.7])
    wanted = []
    for angle in np.radians(np.linspace(-4.0, 4.0, 9)):
        seat = turned((0.5, 0.28), pivot, angle)
        centre = turned((0.75, 0.3), pivot, angle)
        along = (top - seat) / np.linalg.norm(top - seat)
        arm = seat - pivot
        wanted.append((arm[0] * along[1] - arm[1] * along[0]) / (centre - pivot)[0])
    found = swing["motion_ratio.arm.angle.wheel.spring"].values
    assert found == pytest.approx(wanted, rel=1e-12)


def test_roll_centre_of_two_wishbones_is_that_of_the_drawing_board():
    """In the front view the lines of the wishbones meet in the instant centre of the carrier."""
    changes = {
        f"parameters.{arm}.{name}": [f"{value} m" for value in point]
        for arm, points in WISHBONES.items()
        for name, point in points.items()
    }
    changes |= {
        "parameters.wheel.centre": ["0 m", "0.95 m", "0.3 m"],
        "parameters.wheel.inner": ["0 m", "0.8 m", "0.3 m"],
        "parameters.wheel.radius": "0.3 m",
        "parameters.track_rod.inner": ["0.15 m", "0.40 m", "0.22 m"],
        "parameters.track_rod.outer": ["0.15 m", "0.90 m", "0.20 m"],
    }
    model = vd.load("double_wishbone_suspension").changed(changes)
    found = vd.kinematics(model, {"wheel.z": "0.3 m", "rack.displacement": "0 m"})
    (a, b), (c, d) = (
        [np.array(points[name][1:]) for name in ("front", "ball")] for points in WISHBONES.values()
    )
    part = np.linalg.solve(np.column_stack([b - a, c - d]), c - a)[0]
    centre = a + part * (b - a)
    contact = np.array([0.95, 0.0])
    height = -contact[0] * (centre[1] - contact[1]) / (centre[0] - contact[0])
    assert found["roll_centre.wheel.z.wheel"].values[0] == pytest.approx(height, rel=1e-9)
    level = found["instant.wheel.z.wheel.roll_centre_z"].values[0]
    assert level == pytest.approx(height, rel=1e-9)


def test_a_wheel_that_does_not_rise_has_no_motion_ratio():
    found = vd.kinematics(
        "double_wishbone_suspension", {"wheel.z": "313.426 mm", "rack.displacement": "0 mm"}
    )
    assert np.isnan(found["motion_ratio.rack.displacement.wheel.strut"].values).all()
    assert np.isfinite(found["motion_ratio.wheel.z.wheel.strut"].values).all()
