"""An example of each kind of element of system files, for the tests of the catalogue."""

from pathlib import Path

import numpy as np

FRAME = Path(__file__).parents[2] / "systems" / "truck_frame.npz"
CAM = (
    "cam_body: ground, follower_body: b, cam: {outline: {kind: eccentric_circle, radius: 0.4 m, "
    "eccentricity: 10 mm}, follower: {kind: roller, radius: 0.1 m}},"
)
APART = np.hypot(0.3, 0.38)
ELEMENTS = {
    "air_drag": ("body: b, drag_area: 0.5 m^2", lambda s: (0.25 * 1.225 * 4.0**2, 0.0, 0.0)),
    "beam": (
        "body: b, length: 1 m, stiffness: {mass_per_length: 1 kg/m, z: 9 N*m^2}, modes: {z: 2}",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "bouc_wen": (
        "a: {body: ground, point: [-1.7 m, 0, 0]}, b: b, yield_force: 9 N, yield_length: 1 mm, "
        "damping: 2 N*s/m, stiffness: 5 N/m, free_length: 1.5 m",
        lambda s: (2.0 * 4.0 - 5.0 * 0.5, 0.0, 0.0),
    ),
    "bushing": (
        "a: ground, b: {body: b, point: [0, 0, 0.1 m]}, stiffness: [20 N/m, 0, 0], damping: [0, "
        "3 N*s/m, 0]",
        lambda s: (-20.0 * s["b.x"], -3.0 * s["b.y_rate"], 0.0),
    ),
    "cam_contact": (
        f"{CAM} centre: [0, 0, -0.37 m], stiffness: 1e3, exponent: 1",
        lambda s: tuple(1e3 * (0.5 - APART) * n / APART for n in (0.3, 0.0, 0.38)),
    ),
    "cam_impact": (
        f"{CAM} centre: [0, 0, -0.6 m], touching: false",
        lambda s: (0.0, 0.0, 0.0),
    ),
    # On the circle of radius 0.5 m about (0, -0.5), at 5 m/s.
    "cam_joint": (f"{CAM} centre: [0, 0, -0.49 m]", lambda s: (-60.0, 0.0, None)),
    # Far above the ground; the rollers turn with the hub and weigh nothing to speak of.
    "roller_wheel": (
        "hub: b, axis: 2, radius: 0.1 m, rollers: 8, roller_angle: 45.0, roller_radius: 0.02, "
        "roller_mass: 1e-14 kg, centre: [0, 0, 1 m], stiffness: 1e5 N/m, friction: 0.5",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "body_contact": (
        "body_a: ground, body_b: b, plane: {point: [0, 0, -0.08 m]}, ball: {radius: 0.1 m}, "
        "stiffness: 1e3, exponent: 1",
        lambda s: (0.0, 0.0, 20.0),
    ),
    "body_impact": (
        "body_a: ground, body_b: b, capsule: {centre: [0, 0, 2 m], radius: 1 m}, "
        "ball: {radius: 0.1 m}, touching: false",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "engine": (
        "coordinate: b.x, throttle: 0.5, speeds: [-9, 9], full_torques: [7, 7], "
        "drag_torques: [-1, -1]",
        lambda s: (3.0, 0.0, 0.0),
    ),
    "friction_coupling": (
        "coordinate: b.x, limit: 6 N*m, stiffness: 1e3 N*m/rad, damping: 0.5 N*m*s/rad",
        lambda s: (2.0, 0.0, 0.0),
    ),
    "half_shaft": (
        "shaft: b, wheel: b, stiffness: 900 N*m/rad, damping: 4 N*m*s/rad",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "hydraulic_lash": (
        "a: {body: ground, point: [0.3 m, 0, -1 m]}, b: b, area: 1 mm^2, volume: 1 mm^3, length: "
        "0.9 m, bulk_modulus: 1 GPa, leakage: 0, check_valve: 0, stiffness: 5 N/m, preload: 2 N",
        lambda s: (0.0, 0.0, 2.0 - 5.0 * 0.1),
    ),
    "flexible_bar": (
        "body: b, length: 1 m, mass_per_length: 1 kg/m, bending_stiffness: 9 N*m^2, frames: [1]",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "flexible_body": (
        f"body: b, file: {FRAME}, interface: {{left: 3, right: 16}}, modes: 1",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "leaf_friction": (
        "a: {body: ground, point: [4 m, 0, 0]}, b: b, limit: 8 N, transition: 2 mm",
        lambda s: (0.0, 0.0, 0.0),
    ),
    "link": (
        "a: {body: ground, point: [0, 0, 4 m]}, b: b, direction: [0, 0, 1], law: {kind: "
        "spring_damper, stiffness: 5 N/m, free_length: 1 m, damping: 9 N*s/m}",
        lambda s: (0.0, 0.0, 5.0 * (4.0 - 1.0)),
    ),
    # Beam and body, 3 kg together, follow the force of 3 N along the beam.
    "moving_load": (
        "body: beam, place: 0.1 m/s * time, force: [3 N, 0, 0]}, beam: {kind: beam, body: b, "
        "length: 1 m, stiffness: {mass_per_length: 1 kg/m, z: 9 N*m^2}, modes: {z: 2}",
        lambda s: (2.0, 0.0, 0.0),
    ),
    "power_assistance": (
        "coordinate: b.x, torque: 2 N*m, speed: b.x_rate, torques: [0, 4], speeds: [0, 8], "
        "assistance: [0, 8, 0, 4], damping: 0.5 N*m*s/rad",
        lambda s: (3.0 + 2.0, 0.0, 0.0),
    ),
    "spring": (
        "coordinate: b.x, law: {kind: spring_damper, stiffness: 5 N/m, damping: 2 N*s/m}",
        lambda s: (-5.0 * s["b.x"] - 2.0 * s["b.x_rate"], 0.0, 0.0),
    ),
    # The pump is twice as fast as the turbine, x the first and y, at rest, the second.
    "torque_converter": (
        "pump: b.x, turbine: b.y, ratio: 0, speed_ratios: [0, 1], torque_ratios: [1, 1], "
        "capacities: [2, 0]",
        lambda s: (-2.0 * s["b.x_rate"] * abs(s["b.x_rate"]), 0.0, 0.0),
    ),
    "torsion_bar": (
        "coordinate: b.x, other: b.y, stiffness: 5 N*m/rad, damping: 2 N*m*s/rad",
        lambda s: (-5.0 * 0.3 + 2.0 * 4.7, 5.0 * 0.3 - 2.0 * 4.7, 0.0),
    ),
    "wrench": ("body: b, force: [2 N, 0, 3 N/s * time]", lambda s: (2.0, 0.0, 6.0)),
}
"""Fields of a kind, and the force on the body b, free to slide and 0.3 m along x, at rest else but
for its velocity of -4 m/s along x and 0.7 m/s along y, at the time of 2 s."""
