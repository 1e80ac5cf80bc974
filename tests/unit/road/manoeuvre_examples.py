"""Manoeuvres and drivers as a scenario writes them, one of each kind."""

from pathlib import Path

DRIVERS = {
    "preview": "{kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8, "
    "rack_stop: 60 mm}",
    "macadam": "{kind: macadam, preview_time: 1 s, points: 5, speed: 10 m/s, mass: 1600 kg, "
    "yaw_inertia: 1800 kg*m^2, front_distance: 1 m, rear_distance: 1 m, HANDS, "
    "front_stiffness: 60 kN/rad, rear_stiffness: 60 kN/rad, rack_speed: 0.5 m/s}",
    "pure_pursuit": "{kind: pure_pursuit, distance: 5 m, HANDS, rack_acceleration: 20 m/s^2}",
    "stanley": "{kind: stanley, gain: 3 Hz, HANDS}",
}
HANDS = "lag_frequency: 20 rad/s, lag_damping: 0.8, rack_stop: 60 mm"
DRIVERS = {kind: text.replace("HANDS", HANDS) for kind, text in DRIVERS.items()}
SLALOM = (
    "{kind: slalom, cones: 1, spacing: 18 m, first_cone: 4 m, cone_radius: 0.1 m, "
    "path_offset: 1 m, driver: DRIVER}"
)
MANOEUVRES = {
    "acceleration": "{kind: acceleration, torque: 900 N*m, begin: 0}",
    "braking_in_turn": "{kind: braking_in_turn, angle: 3 deg, begin: 0, brake_at: 0.1 s, "
    "torque: 900 N*m}",
    "coast_down": "{kind: coast_down, release_at: 0}",
    "constant_steer": "{kind: constant_steer, angle: 3 deg, begin: 0, accelerate_at: 0.1 s, "
    "last_speed_change: 1 m/s, speed_control: CONTROL}",
    "constant_radius": "{kind: constant_radius, radius: 30 m, begin: 0, last_speed_change: 1 m/s, "
    "driver: DRIVER, speed_control: CONTROL}",
    "crosswind": "{kind: crosswind, force: 900 N, ahead: 0.2 m, begin: 0}",
    "double_lane_change": "{kind: double_lane_change, begin: -14 m, driver: DRIVER}",
    "fishhook": "{kind: fishhook, angle: 8 deg, begin: 0}",
    "j_turn": "{kind: j_turn, angle: 8 deg, begin: 0}",
    "obstacle_avoidance": "{kind: obstacle_avoidance, begin: -11 m, release_at: 0, driver: DRIVER}",
    "steering_robot": "{kind: steering_robot, interval: 50 ms, angles: [0 deg, 1 deg, 3 deg], "
    "fastest: 400 deg/s, lag_frequency: 80 rad/s, towing_gain: 10 kN*s/m}",
    "measured_run": f"{{kind: measured_run, file: {Path(__file__).with_name('measured_run.csv')}}}",
    "open_loop": "{kind: open_loop, times: [0 s, 0.1 s], angles: [0 deg, 3 deg], "
    "brake_torques: [0 N*m, 900 N*m]}",
    "path": "{kind: path, xs: [0 m, 10 m, 20 m], ys: [0 m, 1 m, 5 m], distances: [0 m, 20 m], "
    "speeds: [10 m/s, 8 m/s], driver: DRIVER, speed_control: CONTROL}",
    "pulse_steer": "{kind: pulse_steer, amplitude: 2 deg, width: 0.1 s, begin: 0}",
    "single_sine": "{kind: single_sine, amplitude: 2 deg, frequency: 8 Hz, begin: 0}",
    "slowly_increasing_steer": "{kind: slowly_increasing_steer, angle: 9 deg, begin: 0}",
    "step_steer": "{kind: step_steer, angle: 3 deg, begin: 0}",
    "straight_braking": "{kind: straight_braking, torque: 900 N*m, brake_at: 0}",
    "swept_sine": "{kind: swept_sine, amplitude: 1 deg, sweep_time: 0.2 s, first: 5 Hz, "
    "last: 15 Hz, begin: 0}",
    "split_braking": "{kind: split_braking, torque: 900 N*m, brake_at: 0, low_friction: 0.1}",
    "trailer_sway": "{kind: trailer_sway, amplitude: 2 deg, width: 0.1 s, begin: 0}",
    "weave": "{kind: weave, amplitude: 1 deg, frequency: 10 Hz, begin: 0}",
    "ramp_steer": "{kind: ramp_steer, rate: 10 mm/s, ramp_time: 0.1 s}",
    "sine_steer": "{kind: sine_steer, amplitude: 4 mm, frequency: 2 Hz}",
    "sine_with_dwell": "{kind: sine_with_dwell, amplitude: 6 mm, frequency: 4 Hz, dwell: 10 ms}",
    "slalom": SLALOM.replace("DRIVER", DRIVERS["preview"]),
    "straight": "{kind: straight}",
}
MANOEUVRES = {
    kind: text.replace("DRIVER", DRIVERS["preview"]).replace(
        "CONTROL", "{proportional_gain: 3000 N*s, integral_gain: 300 N}"
    )
    for kind, text in MANOEUVRES.items()
}
SCENARIO = """\
title: A short run
model: iltis
tyres: TYRES
road: ROAD
relaxation: RELAXATION
wheel_spin: SPIN
speed: SPEED
manoeuvre: MANOEUVRE
duration: DURATION
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
DEFAULTS = {
    "ROAD": "{kind: flat}",
    "TYRES": "{kind: magic_formula_1987}",
    "RELAXATION": "null",
    "SPIN": "free",
    "SPEED": "10 m/s",
    "DURATION": "0.3 s",
    "MANOEUVRE": MANOEUVRES["straight"],
}


def written(**changes):
    """Return a scenario with some of its words replaced."""
    text = SCENARIO
    for word, value in (DEFAULTS | changes).items():
        text = text.replace(word, value)
    return text
