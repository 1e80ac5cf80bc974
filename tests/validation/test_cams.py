"""Cams against tables computed independently, and followers in systems against closed forms."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import vehicledyn as vd

DATA = Path(__file__).parent / "data" / "cams"
PARTS = (120, 60, 100)
EXACT = 1e-10
TURN = 2.0 * np.pi


def laws(kind, rise, name="lift", angles=PARTS):
    up, rest, down = angles
    last = 360 - up - rest - down
    found = [{"kind": kind, "over": f"{up} deg", name: rise}]
    found += [{"kind": "dwell", "over": f"{rest} deg"}]
    found += [{"kind": kind, "over": f"{down} deg", name: f"-{rise}"}]
    return [*found, {"kind": "dwell", "over": f"{last} deg"}]


FLAT = {"base_radius": "40 mm", "follower": {"kind": "flat"}}
ROLLER = {
    "base_radius": "40 mm",
    "follower": {"kind": "roller", "radius": "10 mm", "offset": "8 mm"},
}
ROCKER = {
    "base_radius": "40 mm",
    "follower": {"kind": "rocker_roller", "radius": "10 mm", "pivot": "80 mm", "arm": "70 mm"},
}
FACE = {
    "base_radius": "30 mm",
    "follower": {"kind": "rocker_flat", "pivot": "80 mm", "offset": "5 mm"},
}
TABLES = {
    "cam_flat_345": {"motion": laws("polynomial_345", "12 mm"), **FLAT},
    "cam_flat_cycloidal": {"motion": laws("cycloidal", "12 mm"), **FLAT},
    "cam_roller_offset_345": {"motion": laws("polynomial_345", "12 mm"), **ROLLER},
    "cam_osc_roller_345": {"motion": laws("polynomial_345", "15 deg", "swing"), **ROCKER},
    "cam_osc_flat_cycloidal": {
        "motion": laws("cycloidal", "10 deg", "swing", (150, 30, 150)),
        **FACE,
    },
}
COLUMNS = {
    "s": "lift",
    "ds_dtheta": "velocity",
    "d2s_dtheta2": "acceleration",
    "psi_minus_psi0_deg": "lift",
    "dpsi_dtheta": "velocity",
    "d2psi_dtheta2": "acceleration",
    "face_height": "position",
    "roller_centre_height": "position",
    "contact_x_ground": "contact_place",
    "contact_distance_from_pivot_foot": "contact_place",
    "cam_x": "profile_x",
    "cam_y": "profile_y",
    "pitch_x": "pitch_x",
    "pitch_y": "pitch_y",
    "radius_of_curvature": "profile_radius",
    "rho_pitch": "pitch_radius",
    "rho_cam": "profile_radius",
    "pressure_angle_deg": "pressure_angle",
}


@pytest.mark.parametrize("name", TABLES)
def test_tables(name):
    table = np.genfromtxt(DATA / f"{name}.csv", delimiter=",", names=True)
    found = vd.cam(TABLES[name], angles=np.radians(table["theta_deg"]))
    columns = [c for c in table.dtype.names if c not in ("theta_deg", "atan_formula_deg")]
    for column in columns:
        values = found[COLUMNS[column]].values
        if column.endswith("_deg"):
            values = np.degrees(values)
        known = np.isfinite(table[column])
        assert values[known] == pytest.approx(table[column][known], abs=EXACT), column


DISC = """
title: A flat follower on an eccentric disc
gravity: [0, 0, 0]
bodies:
  disc: {{joints: [R2 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
  tappet: {{joints: [{{kind: T3, name: height, role: {role}}}], mass: 0.5 kg}}
drives:
  motor: {{coordinate: disc.angle, law: {{kind: constant_rate, rate: {speed} rad/s}}}}
springs:
  spring:
    coordinate: tappet.height
    law: {{kind: spring_damper, stiffness: 2000 N/m, preload: 20 N, free_length: 30 mm}}
elements:
  contact:
    kind: {kind}
    cam_body: disc
    follower_body: tappet
    cam:
      outline: {{kind: eccentric_circle, radius: 40 mm, eccentricity: 10 mm}}
      follower: {{kind: flat}}
    normal: [0, 0, 1]
    {more}
initial: {{tappet.height: 30 mm}}
"""
E, M, K, F0 = 0.010, 0.5, 2000.0, 20.0


EVENTS = {"kind": "dop853", "relative_tolerance": 1e-11, "absolute_tolerance": 1e-12}
STEPS = {"kind": "rk4", "step": "0.5 ms"}


def run(folder, text, duration, interval="0.1 ms", solver=EVENTS):
    path = folder / "model.yaml"
    path.write_text(text)
    return vd.simulate(
        path,
        duration=f"{math.ceil(1e4 * duration - 1e-6) / 10} ms",
        solver=solver,
        output={"interval": interval},
        backend="interpreted",
    )


def disc(folder, speed, duration, kind="cam_impact", more="friction: 0", role="independent"):
    text = DISC.format(speed=speed, kind=kind, more=more, role=role)
    return run(folder, text, duration)


def ballistic(start, place, rate, time):
    """Return place and rate of the free follower, x'' = -(F0 + k x) / m."""
    w, rest = math.sqrt(K / M), -F0 / K
    phase = w * (time - start)
    x = rest + (place - rest) * np.cos(phase) + rate / w * np.sin(phase)
    return x, rate * np.cos(phase) - (place - rest) * w * np.sin(phase)


def flight(speed):
    """Return lift-off, re-contact, approach velocity and largest gap in closed form."""

    def force(t):
        s, a = E * (1 - math.cos(speed * t)), E * speed**2 * math.cos(speed * t)
        return F0 + K * s + M * a

    off = brentq(force, 0.2 / speed, math.pi / speed, xtol=1e-16)
    s0, v0 = E * (1 - math.cos(speed * off)), E * speed * math.sin(speed * off)

    def gap(t):
        return ballistic(off, s0, v0, t)[0] - E * (1 - np.cos(speed * t))

    grid = off + np.linspace(1e-4, 2.0, 4000) * math.pi / speed
    k = int(np.argmax(gap(grid) < 0.0))
    hit = brentq(gap, grid[k - 1], grid[k], xtol=1e-16)
    rate = ballistic(off, s0, v0, hit)[1] - E * speed * math.sin(speed * hit)
    return off, hit, float(rate), float(gap(np.linspace(off, hit, 20_001)).max())


@pytest.mark.parametrize("speed", [120, 112, 150])
def test_lift_off_flight_and_impact(speed, tmp_path):
    off, hit, rate, most = flight(speed)
    if speed == 120:
        assert [off, hit, rate, most] == pytest.approx(
            [0.02040360621677533, 0.04342143090044017, -0.5976997585722718, 0.001614097412118971],
            rel=1e-6,
        )
    found = disc(tmp_path, speed, hit + 1e-3, more="restitution: 0.5")
    events = {e.name: e.time for e in reversed(found.events)}
    assert events["contact.lifts_off"] == pytest.approx(off, rel=1e-8)
    assert events["contact.hits"] == pytest.approx(hit, rel=1e-8)
    after = found["contact.impact_speed"].values[found["time"].values > hit]
    assert after[0] == pytest.approx(-rate, rel=1e-8)
    time = found["time"].values
    s, v = E * (1 - math.cos(speed * hit)), E * speed * math.sin(speed * hit)
    stretches = (
        (
            (time > off) & (time < hit),
            off,
            E * (1 - math.cos(speed * off)),
            E * speed * math.sin(speed * off),
        ),
        (time > hit, hit, s, v - 0.5 * rate),
    )
    for inside, begin, place, start in stretches:
        x, xd = ballistic(begin, place, start, time[inside])
        gap, opening = (
            x - E * (1 - np.cos(speed * time[inside])),
            xd - E * speed * np.sin(speed * time[inside]),
        )
        assert inside.sum() > 5
        assert found["contact.gap"].values[inside] == pytest.approx(gap, abs=1e-10)
        assert found["contact.gap_rate"].values[inside] == pytest.approx(opening, abs=1e-8)


def test_below_the_threshold_the_follower_stays(tmp_path):
    threshold = math.sqrt((F0 + 2 * K * E) / (M * E))
    stays = disc(tmp_path, threshold * (1 - 1e-6), 0.06)
    assert not stays.events
    leaves = disc(tmp_path, threshold * (1 + 1e-6), 0.06)
    assert leaves.events[0].name == "contact.lifts_off"


def test_the_force_of_a_permanent_contact_is_the_multiplier_and_pulling_is_reported(tmp_path):
    with pytest.warns(vd.AccuracyWarning, match="contact.pulls.*no unilateral contact can"):
        found = disc(tmp_path, 120, 0.05, kind="cam_joint", role="dependent")
    theta = 120 * found["time"].values
    exact = F0 + K * E * (1 - np.cos(theta)) + M * 120**2 * E * np.cos(theta)
    assert found["contact.normal_force"].values == pytest.approx(exact, abs=1e-10)
    assert found.events[0].time == pytest.approx(flight(120)[0], rel=1e-9)


def test_chatter_ends_after_finitely_many_impacts(tmp_path):
    found = disc(tmp_path, 120, 0.06, more="restitution: 0.5")
    hits = [e.time for e in found.events if e.name == "contact.hits"]
    assert 5 < len(hits) < 20
    assert found["contact.gap"].values.min() > -1e-9
    assert found["contact.touches"].values[-1] == 1.0


def test_a_stiff_compliant_contact_approaches_the_rigid_one(tmp_path):
    more = "stiffness: 1e8\n    exponent: 1.0\n    dissipation: 2 s/m"
    found = disc(tmp_path, 120, 0.04, kind="cam_contact", more=more)
    assert found["contact.gap"].values.max() == pytest.approx(flight(120)[3], rel=5e-3)


GUIDED = """
title: A follower that never leaves its cam
gravity: [0, 0, 0]
bodies:
  cam: {{joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
  follower: {follower}
drives:
  motor: {{coordinate: cam.angle, law: {{kind: constant_rate, rate: 100 rad/s}}}}
springs:
  spring: {{coordinate: follower.place, law: {{kind: spring_damper, {spring}}}}}
elements:
  contact:
    kind: cam_joint
    cam_body: cam
    follower_body: follower
    axis: 3
    cam: {cam}
    point: {point}
    {more}
initial: {{follower.place: {start}}}
"""


def guided(name):
    """Return the system of a table's cam and what its follower's coordinate is at no lift."""
    cam = dict(TABLES[name])
    data = vd.cam(cam, angles=[0.0])
    start = float(data["position"].values[0])
    more = "friction: 0"
    if "osc" not in name:
        follower = "{joints: [{kind: T2, name: place, role: dependent}], mass: 0.5 kg}"
        point = "[8 mm, 0, 0]" if "roller" in name else "[0, 0, 0]"
        if "flat" in name:
            more = "normal: [0, 1, 0]"
        spring = f"stiffness: 2000 N/m, preload: 300 N, free_length: {start!r} m"
        load = {"speed": 100.0, "mass": 0.5, "stiffness": 2000.0, "preload": 300.0}
    else:
        # The arm lies along -x of the follower's body at psi = 0; psi turns it clockwise.
        follower = (
            "{at: [80 mm, 0, 0], joints: [{kind: R3, name: place, role: dependent}], mass: 1 kg, "
            "inertia: [0.01 kg*m^2, 0.01 kg*m^2, 0.01 kg*m^2]}"
        )
        point = "[-70 mm, 0, 0]" if "roller" in name else "[-50 mm, -5 mm, 0]"
        if "flat" in name:
            more = "normal: [0, 1, 0]"
        spring = f"stiffness: 30 N*m/rad, preload: -40 N*m, free_length: {-start!r} rad"
        load = {"speed": 100.0, "inertia": 0.01, "turning_stiffness": 30.0, "preload_torque": 40.0}
        start = -start
    text = GUIDED.format(
        follower=follower,
        spring=spring,
        cam=_flow(cam),
        point=point,
        more=more,
        start=f"{start!r} " + ("rad" if "osc" in name else "m"),
    )
    return text, {**cam, "load": load}


def _flow(item):
    if isinstance(item, dict):
        return "{" + ", ".join(f"{k}: {_flow(v)}" for k, v in item.items()) + "}"
    return "[" + ", ".join(map(_flow, item)) + "]" if isinstance(item, list) else str(item)


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.filterwarnings("ignore::vehicledyn.AccuracyWarning")
def test_bodies_on_cams_move_as_the_tables_and_feel_their_normal_force(name, tmp_path):
    """The geometry of the bodies alone, without the follower's formulas, finds both."""
    text, cam = guided(name)
    found = run(tmp_path, text, 0.063, "0.5 ms", STEPS)
    theta = 100.0 * found["time"].values
    data = vd.cam(cam, angles=theta)
    sign = -1.0 if "osc" in name else 1.0
    assert sign * found["follower.place"].values == pytest.approx(
        data["position"].values, abs=EXACT
    )
    force = data["normal_force"].values
    size = np.abs(force).max()
    assert found["contact.normal_force"].values == pytest.approx(force, abs=1e-9 * size)


def test_friction_of_a_sliding_face(tmp_path):
    """A flat face on a dwell: the torque of the motor is μ N times the radius."""
    more = "friction: 0.2\n    creep_speed: 1e-9 m/s"
    text = GUIDED.format(
        follower="{joints: [{kind: T2, name: place, role: dependent}], mass: 0.5 kg}",
        spring="stiffness: 0 N/m, preload: 300 N",
        cam=_flow({"motion": [{"kind": "dwell", "over": "360 deg"}], **FLAT}),
        point="[0, 0, 0]",
        more=f"normal: [0, 1, 0]\n    {more}",
        start="40 mm",
    )
    found = run(tmp_path, text, 0.01, "1 ms", STEPS)
    assert found["cam.angle_force"].values == pytest.approx(np.full(11, 0.2 * 300 * 0.04), rel=1e-9)


GENEVA = """
title: A Geneva drive
gravity: [0, 0, 0]
bodies:
  driver: {joints: [R2 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
  wheel: {joints: [{kind: R2, name: angle, role: dependent}], mass: 1 kg, inertia: [0.1 kg*m^2,
        0.1 kg*m^2, 0.1 kg*m^2]}
drives:
  motor: {coordinate: driver.angle, law: {kind: constant_rate, rate: 10 rad/s}}
constraints:
  geneva: {kind: geneva, driver: driver.angle, wheel: wheel.angle, slots: 6, distance: 80 mm}
"""


def test_geneva_drive(tmp_path):
    """Closed form: the pin at r from the driver's axis, seen from the wheel's at the distance a."""
    found = run(tmp_path, GENEVA, 1.9, "10 ms", {**STEPS, "step": "10 ms"})
    angle = 10.0 * found["time"].values
    turns = np.floor((angle + np.pi) / TURN)
    alpha = angle - TURN * turns
    ratio = math.sin(math.pi / 6)
    inside = np.abs(alpha) < math.pi / 2 - math.pi / 6
    swing = np.where(
        inside,
        np.arctan2(ratio * np.sin(alpha), 1 - ratio * np.cos(alpha)),
        np.sign(alpha) * math.pi / 6,
    )
    exact = -(TURN / 6 * turns + swing)
    assert found["wheel.angle"].values == pytest.approx(exact, abs=1e-12)
    # α'' of the wheel by the driver's angle: λ (λ² - 1) sin α / (1 + λ² - 2 λ cos α)²
    second = (
        ratio * (ratio**2 - 1) * np.sin(alpha) / (1 + ratio**2 - 2 * ratio * np.cos(alpha)) ** 2
    )
    torque = np.where(inside, -0.1 * 100.0 * second, 0.0)
    assert found["geneva.torque"].values == pytest.approx(torque, abs=1e-9)
    arm = 0.08 * np.sqrt(1 + ratio**2 - 2 * ratio * np.cos(alpha))
    force = np.where(inside, torque / arm, 0.0)
    assert found["geneva.pin_force"].values == pytest.approx(force, abs=1e-8)
