"""Carts on omni and mecanum wheels against motions computed independently, and closed forms.

The table was computed with reduced equations and with multipliers, equal to 1e-11.
"""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

TABLE = Path(__file__).parent / "data" / "omni_wheels_own.csv"
EXACT = 1e-9

HEAD = """
title: A cart on universal wheels
gravity: [0, 0, 0]
bodies:
  cart:
    joints:
      - {{kind: T1, name: x, role: independent}}
      - {{kind: T2, name: y, role: independent}}
      - {{kind: R3, name: yaw, role: independent}}
    mass: {mass} kg
    com: [{ahead} m, 0, 0]
    inertia: [{inertia} kg*m^2, {inertia} kg*m^2, {inertia} kg*m^2]
"""
WHEEL = """
  w{k}:
    parent: cart
    at: [{x!r} m, {y!r} m, {radius} m]
    joints: [{{kind: turn, axis: 3, angle: {turn!r} rad}}, R2 spin]
    mass: 1 kg
    inertia: [0, {spin} kg*m^2, 0]
"""
ROLLS = "  c{k}: {{kind: universal_wheel, body: w{k}, axis: 2, radius: {radius} m, "
ROLLS += "roller_angle: {angle} deg}}\n"


def cart(kind, torques=None, rates=(0.0, 0.0, 0.0), ahead=0.0, angle=45.0):
    """Return the text of a system."""
    if kind == "kiwi":
        turns = [math.radians(a) for a in (90, 210, 330)]
        wheels = [(0.25 * math.cos(a), 0.25 * math.sin(a), a + math.pi / 2, 90.0) for a in turns]
        mass, inertia, spin, radius = 20.0, 0.8, 0.01, 0.05
    else:
        signs = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
        wheels = [(0.3 * i, 0.25 * j, 0.0, -i * j * angle) for i, j in signs]
        mass, inertia, spin, radius = 60.0, 4.0, 0.02, 0.1
    # Mass and inertia of the table are those of the whole, wheels included.
    inertia -= sum(x * x + y * y for x, y, _, _ in wheels)
    mass -= len(wheels)
    text = HEAD.format(mass=mass, inertia=inertia, ahead=ahead)
    numbered = list(enumerate(wheels, 1))
    for k, (x, y, turn, _) in numbered:
        text += WHEEL.format(k=k, x=x, y=y, radius=radius, turn=turn, spin=spin)
    text += "constraints:\n"
    for k, wheel in numbered:
        text += ROLLS.format(k=k, radius=radius, angle=wheel[3])
    if torques:
        text += "forces:\n"
        for k, torque in enumerate(torques, 1):
            text += f"  t{k}: {{coordinate: w{k}.spin, force: {torque}}}\n"
    names = ("cart.x_rate", "cart.y_rate", "cart.yaw_rate")
    units = ("m/s", "m/s", "rad/s")
    given = [f"  {n}: {v} {u}\n" for n, v, u in zip(names, rates, units, strict=True)]
    return text + "initial:\n" + "".join(given)


CASES = {
    "kiwi_coast": cart("kiwi", rates=(1.0, 0.0, 2.0)),
    "kiwi_torque": cart(
        "kiwi",
        ["0.4 N*m * sin(2 rad/s * time)", "0.3 N*m", "-0.2 N*m * cos(3 rad/s * time)"],
    ),
    "mecanum_coast": cart("mecanum", rates=(1.0, 0.5, 1.0)),
    "mecanum_torque": cart(
        "mecanum",
        [
            "1 N*m + 1 N*m * sin(time * 1 rad/s)",
            "-0.5 N*m",
            "2 N*m * cos(2 rad/s * time)",
            "0.7 N*m",
        ],
    ),
}


def run(folder, text, duration):
    path = folder / "cart.yaml"
    path.write_text(text)
    solver = {"kind": "dop853", "relative_tolerance": 1e-12, "absolute_tolerance": 1e-13}
    return vd.simulate(
        path, duration=f"{duration} s", solver=solver, output={"interval": "125 ms"},
        backend="interpreted",
    )  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_table(case, tmp_path):
    with TABLE.open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["case"] == case]
    found = run(tmp_path, CASES[case], rows[-1]["t"])
    time = found["time"].values
    at = [int(np.argmin(abs(time - float(row["t"])))) for row in rows]
    assert np.abs(time[at] - [float(row["t"]) for row in rows]).max() < 1e-12
    yaw = found["cart.yaw"].values
    vx, vy = found["cart.x_rate"].values, found["cart.y_rate"].values
    seen = {
        "x": found["cart.x"].values,
        "y": found["cart.y"].values,
        "psi": yaw,
        "vx_body": np.cos(yaw) * vx + np.sin(yaw) * vy,
        "vy_body": np.cos(yaw) * vy - np.sin(yaw) * vx,
        "psidot": found["cart.yaw_rate"].values,
        **{f"phi{k}": found[f"w{k}.spin"].values for k in range(1, 5) if f"w{k}.spin" in found},
    }
    for name, values in seen.items():
        exact = np.array([float(row[name]) for row in rows])
        assert values[at] == pytest.approx(exact, rel=EXACT, abs=EXACT), name


@pytest.mark.parametrize("angle", [30.0, 60.0])
def test_other_roller_angles_and_a_centre_of_mass_beside_the_origin(angle, tmp_path):
    """Rate of the wheels by hand, and the energy of a cart that coasts."""
    found = run(tmp_path, cart("mecanum", rates=(1.0, 0.5, 1.0), ahead=0.1, angle=angle), 1)
    yaw = found["cart.yaw"].values
    vx, vy = found["cart.x_rate"].values, found["cart.y_rate"].values
    u, v = np.cos(yaw) * vx + np.sin(yaw) * vy, np.cos(yaw) * vy - np.sin(yaw) * vx
    turn = found["cart.yaw_rate"].values
    for k, (i, j) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)], 1):
        tilt = math.radians(-i * j * angle)
        along = math.sin(tilt) * (u - 0.25 * j * turn) + math.cos(tilt) * (v + 0.3 * i * turn)
        rate = found[f"w{k}.spin_rate"].values
        assert rate * 0.1 * math.sin(tilt) == pytest.approx(along, abs=1e-11)
    energy = found["energy.kinetic"].values
    assert energy == pytest.approx(np.full(energy.size, energy[0]), rel=1e-11)


def test_rollers_as_bodies_move_a_cart_as_their_average(tmp_path):
    """Three omni wheels of six rollers each on motors; the mean of 0.6 s, to 2 % of the speed."""
    text = cart("kiwi").replace("com: [0.0 m, 0, 0]", "com: [0, 0, 0]")
    text = text.replace("name: y, role: independent}", "name: y}\n      - {kind: T3, name: z}")
    text = text.replace("gravity: [0, 0, 0]", "").replace("mass: 1 kg", "mass: 0.1 kg")
    text = text.replace(
        "inertia: [0, 0.01 kg*m^2, 0]", "inertia: [0.01 kg*m^2, 0.01 kg*m^2, 0.01 kg*m^2]"
    )
    head = text[: text.index("constraints:")]
    u, v, turn, radius = 0.5, 0.25, 0.5, 0.05
    angles = [math.radians(a) for a in (90, 210, 330)]
    rates = [(-math.sin(a) * u + math.cos(a) * v + 0.25 * turn) / radius for a in angles]
    elements, motors = "elements:\n", "forces:\n"
    for k, rate in enumerate(rates, 1):
        elements += (
            f"  e{k}: {{kind: roller_wheel, hub: w{k}, axis: 2, radius: 0.05 m, rollers: 6, "
            "roller_angle: 90.0, roller_radius: 0.012 m, roller_mass: 0.05 kg, stiffness: 2e5 N/m, "
            "dissipation: 1 s/m, friction: 0.6, creep_speed: 0.02 m/s}\n"
        )
        motors += (
            f"  m{k}: {{coordinate: w{k}.spin, force: 5 N*m*s/rad * "
            f"({rate!r} rad/s - w{k}.spin_rate)}}\n"
        )
    path = tmp_path / "rollers.yaml"
    path.write_text(head + elements + motors + "initial:\n  cart.z: -0.3 mm\n")
    found = vd.simulate(
        path, duration="1 s", solver={"kind": "rk4", "step": "40 us"},
        output={"interval": "2 ms"},
    )  # fmt: skip
    late = found["time"].values > 0.4
    yaw, vx, vy = (found[f"cart.{n}"].values[late] for n in ("yaw", "x_rate", "y_rate"))
    seen = [
        np.mean(np.cos(yaw) * vx + np.sin(yaw) * vy),
        np.mean(np.cos(yaw) * vy - np.sin(yaw) * vx),
    ]
    spins = [np.mean(found[f"w{k}.spin_rate"].values[late]) for k in (1, 2, 3)]
    rows = [[-math.sin(a) / radius, math.cos(a) / radius, 0.25 / radius] for a in angles]
    average = np.linalg.solve(rows, spins)
    assert np.hypot(seen[0] - average[0], seen[1] - average[1]) < 0.02 * math.hypot(u, v)
    assert np.mean(found["cart.yaw_rate"].values[late]) == pytest.approx(average[2], rel=0.02)
    weight = 9.81 * (sum(float(m) for m in (17.0, 0.3)) + 18 * 0.05)
    forces = sum(np.mean(found[f"e{k}.normal_force"].values[late]) for k in (1, 2, 3))
    assert forces == pytest.approx(weight, rel=0.02)


def test_a_mecanum_cart_goes_sideways_as_the_average_of_its_leaning_rollers(tmp_path):
    """Eight rollers a wheel: 2.6 % slower than an average that takes them all as upright."""
    text = cart("mecanum").replace("com: [0.0 m, 0, 0]", "com: [0, 0, 0]")
    text = text.replace("name: y, role: independent}", "name: y}\n      - {kind: T3, name: z}")
    text = text.replace("gravity: [0, 0, 0]", "").replace("mass: 1 kg", "mass: 0.2 kg")
    text = text.replace(
        "inertia: [0, 0.02 kg*m^2, 0]", "inertia: [0.02 kg*m^2, 0.02 kg*m^2, 0.02 kg*m^2]"
    )
    elements, motors, start = "elements:\n", "forces:\n", "initial:\n  cart.z: -0.3 mm\n"
    signs = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    for k, (i, j) in enumerate(signs, 1):
        rate = -i * j * 0.5 / 0.1
        elements += (
            f"  e{k}: {{kind: roller_wheel, hub: w{k}, axis: 2, radius: 0.1 m, rollers: 8, "
            f"roller_angle: {-i * j * 45.0}, roller_radius: 0.02 m, roller_mass: 0.05 kg, "
            "stiffness: 2e5 N/m, dissipation: 1 s/m, friction: 0.6, creep_speed: 0.05 m/s}\n"
        )
        motors += (
            f"  m{k}: {{coordinate: w{k}.spin, force: 5 N*m*s/rad * "
            f"({rate!r} rad/s - w{k}.spin_rate)}}\n"
        )
        start += f"  w{k}.spin_rate: {rate!r} rad/s\n"
    path = tmp_path / "rollers.yaml"
    head = text[: text.index("constraints:")]
    path.write_text(head + elements + motors + start + "  cart.y_rate: 0.5 m/s\n")
    found = vd.simulate(
        path, duration="1 s", solver={"kind": "rk4", "step": "20 us"},
        output={"interval": "2 ms"},
    )  # fmt: skip
    late = found["time"].values > 0.4
    spins = [np.mean(found[f"w{k}.spin_rate"].values[late]) for k in (1, 2, 3, 4)]
    seen = np.mean(found["cart.y_rate"].values[late])
    turned = np.mean([-i * j * rate for (i, j), rate in zip(signs, spins, strict=True)])
    leaning = math.sin(math.pi / 8) / (math.pi / 8)
    assert seen == pytest.approx(0.1 * turned * leaning, rel=4e-3)
    slow = cart("mecanum", rates=(0.0, 0.5, 0.0))
    slow = slow.replace("45.0 deg}", "45.0 deg, rollers: 8}")
    averaged = run(tmp_path, slow, 0.25)
    rate = averaged["w2.spin_rate"].values[-1]
    assert 0.1 * rate * leaning == pytest.approx(0.5, rel=1e-9)
