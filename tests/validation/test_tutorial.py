"""The systems of the tutorial against closed forms written by hand."""

import numpy as np
import pytest
from reference_cases.system_files import TIGHT, motion, parameters, ready
from scipy.optimize import fsolve

from vehicledyn.analyse.linearise import linearise
from vehicledyn.analyses.preparation.prepare import equilibrium_point

pytestmark = pytest.mark.validation

G = 9.81
LIFT = np.array([0.0, 0.0, G])
ALGEBRA = 1e-10
MOTION = 1e-8


def state_of(prepared, **values):
    return np.array([values.get(s.name, s.start) for s in prepared.equations.states])


def rates_at(prepared, time, state):
    e, kernel = prepared.equations, prepared.kernel
    unknowns = kernel.solve_unknowns(time, state, np.array([u.start for u in e.unknowns]))
    rates = kernel.rates(time, state, unknowns)
    outputs = kernel.outputs(time, state, unknowns)
    return (
        dict(zip((s.name for s in e.states), rates, strict=True)),
        dict(zip((c.name for c in e.channels), outputs, strict=True)),
    )


def test_double_spring_mass_has_the_frequencies_of_its_two_masses():
    prepared = ready("double_spring_mass", "upper.damping=0", "lower.damping=0")
    p = parameters(prepared)
    k1, k2 = p["upper.stiffness"], p["lower.stiffness"]
    m1, m2 = p["upper.mass"], p["lower.mass"]
    # m1 m2 ω⁴ - (m1 k2 + m2 (k1 + k2)) ω² + k1 k2 = 0
    half = 0.5 * (m1 * k2 + m2 * (k1 + k2)) / (m1 * m2)
    squares = half + np.array([-1.0, 1.0]) * np.sqrt(half**2 - k1 * k2 / (m1 * m2))
    point = equilibrium_point(prepared, 0.0, "static")
    e = prepared.equations
    found = linearise(e, prepared.kernel.parameters, 0.0, point.state, point.unknowns)
    values = np.linalg.eigvals(found.matrix)
    assert np.sort(np.abs(values.imag))[::2] == pytest.approx(np.sqrt(squares), rel=ALGEBRA)
    heights = dict(zip((s.name for s in e.states), point.state, strict=True))
    assert heights["upper.height"] == pytest.approx(-(m1 + m2) * G / k1, rel=ALGEBRA)
    assert heights["lower.height"] == pytest.approx(-m2 * G / k2, rel=ALGEBRA)


def seat_by_hand(p, rotor, out, forward):
    """Accelerations of a seat's angles and the torque it asks of the rotor, Newton in the rotor.

    Axes of the hinge: radial, along the rim, up; ``rotor`` are rate and angular acceleration,
    ``out`` and ``forward`` angle and rate.
    """
    length, m, (a, da), (b, db) = p["rod"], p["seat.mass"], out, forward
    sa, ca, sb, cb = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
    place = length * np.array([sa * cb, sb, -ca * cb])
    slopes = length * np.array([[ca * cb, -sa * sb], [0.0, cb], [sa * cb, ca * sb]])
    bend = length * np.array(
        [
            -sa * cb * (da**2 + db**2) - 2.0 * ca * sb * da * db,
            -sb * db**2,
            ca * cb * (da**2 + db**2) - 2.0 * sa * sb * da * db,
        ]
    )
    speed = slopes @ [da, db]
    turn, spin_up = np.array([0.0, 0.0, rotor[0]]), np.array([0.0, 0.0, rotor[1]])
    arm = place + np.array([p["radius"], 0.0, 0.0])
    carried = np.cross(spin_up, arm) + np.cross(turn, np.cross(turn, arm))
    known = bend + carried + 2.0 * np.cross(turn, speed) + LIFT
    damping = -p["seat.damping"] * np.array([da, db])
    angles = np.linalg.solve(m * slopes.T @ slopes, damping - m * slopes.T @ known)
    force = m * (slopes @ angles + known)
    return angles, np.cross(arm, force)[2]


@pytest.mark.parametrize("seed", range(4))
def test_merry_go_round_swings_and_needs_the_torque_of_newtons_law(seed):
    prepared = ready("merry_go_round")
    p = parameters(prepared)
    random, time = np.random.default_rng(seed), 1.0 + seed
    state = 0.6 * random.uniform(-1.0, 1.0, len(prepared.equations.states))
    rates, channels = rates_at(prepared, time, state)
    fading = np.exp(-time / p["spin_up"])
    rotor = p["rate"] * (1.0 - fading), p["rate"] / p["spin_up"] * fading
    torque = p["rotor.inertia"] * rotor[1]
    for k in range(1, 5):
        out, forward = (
            (channels[f"seat_{k}.{n}"], channels[f"seat_{k}.{n}_rate"])
            for n in ("outward", "forward")
        )
        wanted, needed = seat_by_hand(p, rotor, out, forward)
        torque += needed
        found = rates[f"seat_{k}.outward_rate"], rates[f"seat_{k}.forward_rate"]
        assert found == pytest.approx(wanted, rel=ALGEBRA, abs=ALGEBRA)
    assert channels["rotor.turn_force"] == pytest.approx(torque, rel=ALGEBRA)


def test_merry_go_round_ends_in_its_conical_swing():
    """tan θ = ω² (R + L sin θ)/g, for each seat."""
    run = motion("merry_go_round", "duration=50 s", "parameters.seat.damping=1.2 kN*m*s/rad")
    p = parameters(run.prepared)
    angle = run["seat_1.outward"][-1]
    pull = p["rate"] ** 2 * (p["radius"] + p["rod"] * np.sin(angle)) / G
    assert np.tan(angle) == pytest.approx(pull, rel=1e-6)
    for k in range(2, 5):
        assert run[f"seat_{k}.outward"] == pytest.approx(run["seat_1.outward"], abs=MOTION)


@pytest.mark.parametrize("seed", range(4))
def test_radiation_counter_needs_the_forces_of_polar_coordinates(seed):
    """m (r'' - r ψ'²), m (g + z'') and (I ψ')' of three driven axes, and a spring below."""
    prepared = ready("radiation_counter")
    p = parameters(prepared)
    time = 2.0 + 0.9 * seed
    sag, speed = np.random.default_rng(seed).normal(scale=0.02, size=2)
    rates, channels = rates_at(prepared, time, np.array([sag, speed]))
    sweep, reach = (2.0 * np.pi * p[f"{n}.frequency"] for n in ("sweep", "reach"))
    turned = p["sweep.amplitude"] * sweep * np.cos(sweep * time)
    turning = -p["sweep.amplitude"] * sweep**2 * np.sin(sweep * time)
    out = p["reach.least"] + p["reach.amplitude"] * np.sin(reach * time)
    faster = p["reach.amplitude"] * reach * np.cos(reach * time)
    pulled = -p["reach.amplitude"] * reach**2 * np.sin(reach * time)
    # Acceleration of the carriage by differences of its channel.
    rise = [channel_at(prepared, time + d, "carriage.climb_rate") for d in (-1e-5, 1e-5)]
    lift = (rise[1] - rise[0]) / 2e-5
    head, carried = p["head.mass"], p["arm.mass"] + p["head.mass"]
    guard = p["head.stiffness"] * sag + p["head.damping"] * speed
    assert rates["head.sag_rate"] == pytest.approx(-guard / head - G - lift, rel=1e-8)
    inertia = p["column.inertia"] + p["arm.inertia"] + carried * out**2
    torque = inertia * turning + 2.0 * carried * out * faster * turned
    assert channels["column.sweep_force"] == pytest.approx(torque, rel=ALGEBRA)
    assert channels["arm.reach_force"] == pytest.approx(
        carried * (pulled - out * turned**2), rel=ALGEBRA
    )
    weight = (p["carriage.mass"] + p["arm.mass"]) * (G + lift) - guard
    assert channels["carriage.climb_force"] == pytest.approx(weight, rel=1e-8)


def channel_at(prepared, time, name):
    return rates_at(prepared, time, state_of(prepared))[1][name]


# The tricycle.


def test_tricycle_runs_the_circle_of_its_steer_angle():
    """R = L/tan δ about the rear axle; speeds of the wheels from the circle alone."""
    run = motion("tricycle", *TIGHT)
    p = parameters(run.prepared)
    late = run.time > 5.0
    x, y = run["frame.x"][late], run["frame.y"][late]
    # A circle through all points: x² + y² = a x + b y + c.
    a, b, c = np.linalg.lstsq(np.column_stack([x, y, np.ones_like(x)]), x**2 + y**2, rcond=None)[0]
    radius = np.sqrt(0.25 * (a * a + b * b) + c)
    wanted = p["wheelbase"] / np.tan(p["steer"])
    assert radius == pytest.approx(wanted, rel=1e-9)
    speed = np.hypot(run["frame.x_rate"], run["frame.y_rate"])[late]
    yaw_rate = run["frame.yaw_rate"][late]
    assert speed == pytest.approx(wanted * yaw_rate, rel=1e-9)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        path = yaw_rate * (wanted + 0.5 * sign * p["track"])
        spin = run[f"{side}_wheel.spin_rate"][late]
        assert spin * p["rear.radius"] == pytest.approx(path, rel=1e-9)
    front = yaw_rate * np.hypot(wanted, p["wheelbase"])
    assert run["front_wheel.spin_rate"][late] * p["front.radius"] == pytest.approx(front, rel=1e-9)
    assert run["constraints.velocity_error"].max() < 1e-12


def test_tricycle_has_two_freedoms_less_the_handlebar_and_names_what_is_redundant():
    structure = ready("tricycle").equations.structure
    assert structure["degrees_of_freedom"] == 1
    assert set(structure["redundant"]) <= {"left_contact", "right_contact"}
    assert structure["redundant"]


def test_contacts_of_the_tricycle_carry_it_round_its_circle():
    """Forces and moments of all three wheels about the rear axle's middle, on the circle.

    Every body turns with Ω about the vertical, so a place p accelerates with Ω × (Ω × (p - o))
    and a spinning wheel needs the moment Ω × C ω. How the rear wheels share the force along
    their axle is undetermined; it has no moment about the middle.
    """
    prepared = ready("tricycle", "pedal=0")
    p = parameters(prepared)
    turning = 1.1
    wanted = p["wheelbase"] / np.tan(p["steer"])
    known = {"front_wheel.spin": turning * np.hypot(wanted, p["wheelbase"]) / p["front.radius"]}
    speeds = {
        "left_wheel.spin": turning * (wanted - 0.5 * p["track"]) / p["rear.radius"],
        "right_wheel.spin": turning * (wanted + 0.5 * p["track"]) / p["rear.radius"],
        "frame.yaw": turning,
        "frame.x": turning * wanted,
        **known,
    }
    values = {f"{n}_rate": v for n, v in speeds.items()}
    state = state_of(prepared, **values)
    _, found = rates_at(prepared, 20.0, state)
    for name, value in values.items():
        assert found[name] == pytest.approx(value, rel=ALGEBRA), name
    # Bodies: mass, place from the middle of the rear axle, spin momentum along its axle.
    axle = np.array([-np.sin(p["steer"]), np.cos(p["steer"]), 0.0])
    half, low = 0.5 * p["track"], p["rear.radius"]
    spin = {n: 0.5 * p[f"{n}.mass"] * p[f"{n}.radius"] ** 2 for n in ("rear", "front")}
    sideways = np.array([0.0, 1.0, 0.0])
    bodies = [
        (p["frame.mass"], [p["place"], 0.0, p["height"]], 0.0 * axle),
        (p["rear.mass"], [0.0, half, low], spin["rear"] * speeds["left_wheel.spin"] * sideways),
        (p["rear.mass"], [0.0, -half, low], spin["rear"] * speeds["right_wheel.spin"] * sideways),
        (
            p["front.mass"],
            [p["wheelbase"], 0.0, p["front.radius"]],
            spin["front"] * speeds["front_wheel.spin"] * axle,
        ),
    ]
    up, centre = np.array([0.0, 0.0, turning]), np.array([0.0, wanted, 0.0])
    force, moment = np.zeros(3), np.zeros(3)
    for mass, place, momentum in bodies:
        arm = np.array(place)
        pull = mass * (np.cross(up, np.cross(up, arm - centre)) + LIFT)
        force += pull
        moment += np.cross(arm, pull) + np.cross(up, momentum)
    given, turned = np.zeros(3), np.zeros(3)
    contacts = {
        "left_contact": ([0.0, half, 0.0], sideways),
        "right_contact": ([0.0, -half, 0.0], sideways),
        "front_contact": ([p["wheelbase"], 0.0, 0.0], axle),
    }
    for name, (place, left) in contacts.items():
        along = found[f"{name}.longitudinal_force"] * np.cross(left, [0.0, 0.0, 1.0])
        across = found.get(f"{name}.lateral_force", 0.0) * left
        push = along + across + [0.0, 0.0, found[f"{name}.normal_force"]]
        given += push
        turned += np.cross(place, push)
    assert given[[0, 2]] == pytest.approx(force[[0, 2]], abs=1e-9)
    assert turned == pytest.approx(moment, abs=1e-9)
    assert min(found[f"{name}.normal_force"] for name in contacts) > 10.0


# The jeep and its suspension.


def turned(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = [k for k in range(3) if k != axis]
    matrix = np.eye(3)
    sign = -1.0 if axis == 1 else 1.0
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -sign * s, sign * s
    return matrix


def axle_by_hand(rods, travel, roll):
    """Place and angles of a rigid axle on four rods, by Newton's method on their lengths."""
    lengths = [np.linalg.norm(np.subtract(*rod)) for rod in rods]

    def gaps(values):
        x, y, yaw, pitch = values
        tilted = turned(0, roll)
        origin = np.array([0.0, 0.0, travel]) + tilted @ [x, y, 0.0]
        rotation = tilted @ turned(2, yaw) @ turned(1, pitch)
        ends = [origin + rotation @ np.array(end) for _, end in rods]
        return [
            np.linalg.norm(end - np.array(anchor)) - length
            for end, (anchor, _), length in zip(ends, rods, lengths, strict=True)
        ]

    return fsolve(gaps, np.zeros(4), xtol=1e-14)


@pytest.mark.parametrize(("travel", "roll"), [(0.06, 0.0), (-0.08, 0.1), (0.03, -0.15)])
def test_axle_of_the_jeep_suspension_follows_its_rods(travel, roll):
    prepared = ready("jeep_suspension")
    flip = np.array([1.0, -1.0, 1.0])
    p = parameters(prepared)
    place = {
        n: np.array([p[f"{n}.{c}"] for c in "xyz"])
        for n in (
            "lower.chassis", "lower.axle", "upper.chassis", "upper.axle", "panhard.chassis",
            "panhard.axle",
        )
    }  # fmt: skip
    lower = place["lower.chassis"], place["lower.axle"]
    rods = [
        (place["upper.chassis"], place["upper.axle"]),
        (place["panhard.chassis"], place["panhard.axle"]),
        lower,
        (lower[0] * flip, lower[1] * flip),
    ]
    state = state_of(prepared, **{"axle.travel": travel, "axle.roll": roll})
    _, channels = rates_at(prepared, 0.0, state)
    names = ("axle.x", "axle.y", "axle.yaw", "axle.pitch")
    wanted = axle_by_hand(rods, travel, roll)
    assert np.abs(wanted).max() > 1e-3
    assert [channels[n] for n in names] == pytest.approx(wanted, abs=1e-11)


def test_jeep_suspension_carries_body_and_axle():
    prepared = ready("jeep_suspension")
    p = parameters(prepared)
    point = equilibrium_point(prepared, 0.0, "static")
    values = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    found = dict(zip((c.name for c in prepared.equations.channels), values, strict=True))
    load = sum(found[f"{side}_plate.height_force"] for side in ("left", "right"))
    assert load == pytest.approx(G * (p["body.mass"] + p["axle.mass"]), rel=1e-9)


def test_jeep_stands_on_its_wheels():
    prepared = ready("jeep")
    p = parameters(prepared)
    point = equilibrium_point(prepared, 0.0, "static")
    values = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    found = dict(zip((c.name for c in prepared.equations.channels), values, strict=True))
    loads = {n: v for n, v in found.items() if n.endswith("normal_force")}
    assert len(loads) == 4
    weight = G * (p["body.mass"] + 2.0 * p["axle.mass"] + 4.0 * p["wheel.mass"])
    assert sum(loads.values()) == pytest.approx(weight, rel=1e-9)
    # Moment about the y axis: body at the origin of the chassis, axles at theirs.
    front, rear = (
        sum(v for n, v in loads.items() if n.startswith(axle)) for axle in ("front", "rear")
    )
    own = G * (p["axle.mass"] + 2.0 * p["wheel.mass"])
    lever = p["front.axle"] * (front - own) + p["rear.axle"] * (rear - own)
    # The axles move along by a tenth of a millimetre, the body leans by 0.14 degrees.
    assert lever == pytest.approx(0.0, abs=1e-3 * weight)


@pytest.mark.parametrize("seed", range(3))
def test_small_carts_have_their_linear_frequencies(seed):
    """The cart that rolls: 1/ω² from load and the carried mass with its rolling axles."""
    stiffness = 30.0 + 40.0 * seed
    prepared = ready("small_cart_2", f"load.stiffness={stiffness} N/m", "load.damping=0")
    p = parameters(prepared)
    rolling = p["cart.mass"] + 2.0 * p["axle.mass"] * 1.5
    reduced = rolling * p["load.mass"] / (rolling + p["load.mass"])
    e = prepared.equations
    x = state_of(prepared)
    unknowns = [u.start for u in e.unknowns]
    found = linearise(e, prepared.kernel.parameters, 0.0, x, unknowns).matrix
    assert np.abs(np.linalg.eigvals(found).imag).max() == pytest.approx(
        np.sqrt(stiffness / reduced), rel=ALGEBRA
    )
