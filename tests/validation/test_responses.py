"""Frequency responses: closed forms, and the sine drives of time simulation."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.linear.frequency_grid import FrequencyGrid
from vehicledyn.analyses.linear.response import find_response
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.validation
GRID = FrequencyGrid(0.05, 40.0, 41)
S = 2j * np.pi * GRID.frequencies()


def quiet(text, fraction):
    pass


def respond(target, inputs, outputs, **options):
    inputs, outputs = [[item] if isinstance(item, str) else item for item in (inputs, outputs)]
    return find_response(
        target, inputs=inputs, outputs=outputs, progress=quiet, **{"grid": GRID, **options}
    )


def curve(target, given, output, **options):
    """Return the complex response of one output to one input."""
    return respond(target, given, output, **options).table.response[:, 0, 0]


@pytest.fixture
def system(tmp_path):
    """Write a system file and return it as a model."""

    def write(text, *changes):
        path = tmp_path / "system.yaml"
        path.write_text(text, encoding="utf-8")
        return load_model(str(path), changes)

    return write


def assert_equal(found, exact, rel=1e-9):
    assert np.abs(found - exact).max() <= rel * np.abs(exact).max()
    assert np.abs(found / exact - 1.0).max() < 1e-7


SUSPENDED = """
title: A mass on a spring and a damper above a base that moves
parameters: {mass: 12 kg, stiffness: 4 kN/m, damping: 60 N*s/m, extra: 0 N}
gravity: [0, 0, 0]
bodies:
  base: {joints: [{kind: T3, name: height, role: driven}]}
  body: {at: [0, 0, 1 m], joints: [T3 height], mass: mass}
links:
  strut:
    a: base
    b: body
    law:
      kind: spring_damper
      stiffness: stiffness
      damping: damping
      free_length: 1 m
      preload: extra
"""


def test_transmissibility_of_one_mass(system):
    """G = (c s + k)/(m s² + c s + k) by the base, 1/(m s² + c s + k) by a force."""
    model = system(SUSPENDED)
    below = 12.0 * S**2 + 60.0 * S + 4000.0
    report = respond(model, ["base.height", "force:body.height", "parameter:extra"], "body.height")
    moved, loaded, preloaded = report.table.response[:, :, 0].T
    assert_equal(moved, (60.0 * S + 4000.0) / below)
    assert_equal(loaded, 1.0 / below)
    assert_equal(preloaded, -1.0 / below)
    assert report.table.static_gain[:, 0] == pytest.approx([1.0, 1 / 4000, -1 / 4000], rel=1e-12)
    # by the damping ratio ζ and r = ω/ω_n the peak lies at r² = (√(1 + 8 ζ²) - 1)/(4 ζ²)
    ratio, natural = 60.0 / (2.0 * np.sqrt(4000.0 * 12.0)), np.sqrt(4000.0 / 12.0)
    place = np.sqrt((np.sqrt(1.0 + 8.0 * ratio**2) - 1.0) / (4.0 * ratio**2))
    figures = report.figures[0, 0]
    assert figures.peak_frequency == pytest.approx(place * natural / (2 * np.pi), rel=1e-6)
    edge = 2j * np.pi * figures.bandwidth
    size = abs((60.0 * edge + 4000.0) / (12.0 * edge**2 + 60.0 * edge + 4000.0))
    assert size == pytest.approx(np.sqrt(0.5), rel=1e-9)


def test_rates_and_forces_follow_their_coordinates(system):
    """By the base: its own rate and acceleration s, s², the force that its drive needs."""
    model = system(SUSPENDED)
    names = ["base.height", "base.height_rate", "strut.force", "base.height_force"]
    base, rate, force, drive = respond(model, "base.height", names).table.response[:, 0, :].T
    assert_equal(base, np.ones_like(S))
    assert_equal(rate, S)
    below = 12.0 * S**2 + 60.0 * S + 4000.0
    carried = 12.0 * S**2 * (60.0 * S + 4000.0) / below
    assert_equal(force, -carried)  # tension
    assert_equal(drive, carried)


def test_two_masses_of_a_quarter_car():
    """Wheel and body from their matrices, (M s² + C s + K)⁻¹ K_t."""
    model = load_model(str(ROOT / "systems/quarter_car.yaml"))
    m, k, c, m_w, k_t = 300.0, 18e3, 1.2e3, 40.0, 180e3
    exact = []
    for s in S:
        matrix = np.array(
            [[m_w * s**2 + c * s + k + k_t, -c * s - k], [-c * s - k, m * s**2 + c * s + k]]
        )
        exact.append(np.linalg.solve(matrix, [k_t, 0.0]))
    wheel, body = np.array(exact).T
    found = respond(model, "shaker", ["wheel.height", "body.height", "tyre.force"]).table
    assert_equal(found.response[:, 0, 0], wheel)
    assert_equal(found.response[:, 0, 1], body)
    assert_equal(np.abs(found.response[:, 0, 2]), np.abs(k_t * (wheel - 1.0)))


CART = """
title: A pendulum hangs on a cart
parameters: {cart: 3 kg, bob: 0.5 kg, rod: 0.7 m, damping: 2 N*s/m}
bodies:
  cart: {joints: [{kind: T1, name: x, ROLE}], mass: cart}
  bob: {parent: cart, joints: [R2 angle], mass: bob, com: [0, 0, -rod]}
springs:
  wheels: {coordinate: cart.x, law: {kind: spring_damper, damping: damping}}
wrenches:
  wind: {body: bob, point: [0, 0, -rod], force: [0, 0, 0]}
"""


def test_pendulum_on_a_cart_by_a_force(system):
    """(M + m) x'' - m l φ'' + d x' = F, l φ'' - x'' + g φ = 0, φ about y, bob at x - l φ."""
    model = system(CART.replace("ROLE", "role: independent"))
    total, bob, length, damping = 3.5, 0.5, 0.7, 2.0
    swing = S**2 / (length * S**2 + 9.81)  # φ/x
    below = total * S**2 + damping * S - bob * length * S**2 * swing
    report = respond(model, "force:cart.x", ["cart.x", "bob.angle", "cart.x_rate"])
    x, angle, rate = report.table.response[:, 0, :].T
    assert_equal(x, 1.0 / below)
    assert_equal(angle, swing / below)
    assert_equal(rate, S / below)
    # at rest the cart runs away at F/d, the bob hangs still
    assert np.isnan(report.table.static_gain[0, 0])
    assert report.table.static_gain[0, 1:] == pytest.approx([0.0, 0.5], abs=1e-12)


def test_pendulum_on_a_cart_that_is_moved(system):
    """φ/x = s²/(l s² + g): the acceleration of the drive alone moves it; wind pushes at the bob."""
    model = system(CART.replace("ROLE", "role: driven"))
    found = respond(model, ["cart.x", "wind.force_x", "wrench:bob.force_x@0,0,-0.7"], "bob.angle")
    moved, own, at_point = found.table.response[:, :, 0].T
    assert_equal(moved, S**2 / (0.7 * S**2 + 9.81))
    assert_equal(own, -1.0 / (0.5 * (0.7 * S**2 + 9.81)))
    assert_equal(at_point, own)
    assert found.undamped == pytest.approx([np.sqrt(9.81 / 0.7) / (2 * np.pi)], rel=1e-12)
    pole = found.undamped[0]
    near = respond(model, "wind.force_x", "bob.angle", at=[pole * (1.0 + 1e-7)]).response_at[
        0, 0, 0
    ]
    s = 2j * np.pi * pole * (1.0 + 1e-7)
    assert near == pytest.approx(-1.0 / (0.5 * (0.7 * s**2 + 9.81)), rel=1e-6)


def test_an_undamped_pole_is_told_not_hidden(system):
    """ω² = k/m with k = 4 π² N/m is exactly 1 Hz: infinite there, exact beside it."""
    spring = "law: {kind: spring_damper, stiffness: 39.47841760435743 N/m}"
    model = system(
        "title: A mass on a spring\ngravity: [0, 0, 0]\n"
        "bodies: {a: {joints: [T1 x], mass: 1 kg}}\n"
        f"springs: {{s: {{coordinate: a.x, {spring}}}}}\n"
    )
    grid = FrequencyGrid(0.5, 1.5, 3, "linear")
    report = respond(model, "force:a.x", "a.x", grid=grid)
    low, pole, high = report.table.response[:, 0, 0]
    assert (low, high) == pytest.approx([1 / (0.75 * 4 * np.pi**2), -1 / (5 * np.pi**2)])
    assert abs(pole) > 1e12
    assert report.undamped == pytest.approx([1.0], rel=1e-12)
    assert report.figures[0, 0].peak > 1e12
    assert report.figures[0, 0].peak_frequency == pytest.approx(1.0, rel=1e-12)
    assert "undamped modes at 1 Hz: the response may be unbounded there" in report.as_text()


WHEELED = """
title: One wheel carries a load over a road
bodies:
  load: {at: [0, 0, 0.3 m], joints: [T3 height], mass: 200 kg}
  wheel: {parent: load, joints: [R2 spin], mass: 10 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2],
        spins_about: 2}
wheels:
  corner:
    body: wheel
    radius: 0.3 m
    stiffness: 150 kN/m
    damping: 900 N*s/m
    axle: front
    side: left
    tyre: {kind: magic_formula_1987}
road: {ROAD}
"""


@pytest.mark.parametrize(
    "road",
    [
        "kind: flat",
        "kind: sine, amplitude_x: 0 m, wavelength_x: 9 m, amplitude_y: 0 m, wavelength_y: 9 m",
    ],
)
def test_road_under_a_wheel_that_stands(system, road):
    """A shaker lifts the ground: G = (c s + k)/(m s² + c s + k), damping of the tyre included."""
    found = curve(system(WHEELED.replace("ROAD", road)), "road:corner", "load.height")
    assert_equal(found, (900.0 * S + 150e3) / (210.0 * S**2 + 900.0 * S + 150e3))


def fitted(time, values, frequency):
    """Return the complex amplitude of a sine in samples that may also drift."""
    phase = 2.0 * np.pi * frequency * time
    table = np.stack([np.sin(phase), np.cos(phase), np.ones_like(time), time], axis=1)
    found = np.linalg.lstsq(table, values, rcond=None)[0]
    return complex(found[0], found[1])


def simulated(text, folder, frequency, changes=()):
    """Run a scenario; return a reader of amplitudes and means over its last whole periods."""
    path = folder / "drive.yaml"
    path.write_text(text, encoding="utf-8")
    output = folder / "drive.h5"
    run_scenario(load_scenario(path, changes), output=output, backend="auto", progress=quiet)
    with open_result(output) as result:
        time, table = result.time, result.as_frame()
    kept = time >= time[-1] - np.floor(0.3 * time[-1] * frequency) / frequency - 1e-9

    def read(channel):
        values = table[channel].to_numpy()[kept]
        return fitted(time[kept], values, frequency), values.mean()

    return read


def test_shaken_quarter_car_as_simulated(tmp_path):
    for frequency in (0.7, 9.0):
        found = respond(
            load_model(str(ROOT / "systems/quarter_car.yaml")), "road.height", "body.height",
            at=[frequency],
        ).response_at[0, 0, 0]  # fmt: skip
        text = f"""
title: Shaken
model: {ROOT}/systems/quarter_car.yaml
parameters: {{shaker: {{amplitude: 10 mm, frequency: {frequency} Hz}}}}
duration: 16 s
solver: {{kind: dop853, relative_tolerance: 1e-10, absolute_tolerance: 1e-12}}
output: {{interval: 10 ms}}
"""
        run, _ = simulated(text, tmp_path, frequency)("body.height")
        assert abs(run / 0.01 / found - 1.0) < 1e-6


@pytest.mark.parametrize("frequency", [0.5, 2.0])
def test_iltis_yaw_rate_as_in_a_sine_steer(tmp_path, frequency):
    """The rack moves by 20 µm at 20 m/s; amplitude and phase agree to 1e-4 of the amplitude.

    Nothing drives the wheels against the tyres' drag, so the speed falls by some mm/s; the gains
    grow with the speed, so the response is taken at the one that was reached.
    """
    names = ["body.yaw_rate", "accelerometer.lateral", "chassis.roll"]
    scenario = ROOT / "scenarios/iltis_sine_steer.yaml"
    text = scenario.read_text(encoding="utf-8").replace("amplitude: 2 mm", "amplitude: 20 um")
    text = text.replace("frequency: 1 Hz", f"frequency: {frequency} Hz")
    text = text.replace("duration: 3 s", "duration: 12 s")
    read = simulated(text, tmp_path, frequency)
    _, speed = read("body.forward_speed")
    assert speed == pytest.approx(20.0, abs=0.005)
    linear = respond(
        load_scenario(scenario), "steering", names, at=[frequency], speed=speed
    ).response_at[0, 0]
    for name, expected in zip(names, linear, strict=True):
        found, _ = read(name)
        assert abs(found / 20e-6 / expected - 1.0) < 2e-5


def test_steady_gains_of_the_iltis_agree_with_its_slow_response():
    """Yaw rate settles although heading and place do not; the response tends to it."""
    model = load_model("iltis")
    report = respond(
        model, ["steering", "road_wheel_angle"], ["body.yaw_rate", "chassis.y"], speed=20.0,
        grid=FrequencyGrid(1e-4, 1e-3, 3),
    )  # fmt: skip
    gain = report.table.static_gain
    assert gain[0, 0] == pytest.approx(report.table.response[0, 0, 0].real, rel=1e-7)
    assert 3.0 < gain[1, 0] < 8.0  # towards v/L for neutral steer, 9.9 1/s, less if it understeers
    assert np.isnan(gain[:, 1]).all()
    assert report.growing == 0


def test_road_of_the_iltis_sums_up():
    """Wheels together lift as one; on a long wave the car follows the profile of the road."""
    wheels = [f"road:wheel_{corner}" for corner in ("fl", "fr", "rl", "rr")]
    inputs = ["road", *wheels, "road:front", "profile"]
    report = respond(
        load_model("iltis"), inputs, ["chassis.z", "chassis.pitch"], speed=10.0,
        grid=FrequencyGrid(0.01, 20.0, 9),
    )  # fmt: skip
    response = report.table.response
    assert np.abs(response[:, 0] - response[:, 1:5].sum(axis=1)).max() < 1e-9
    assert np.abs(response[:, 5] - response[:, 1:3].sum(axis=1)).max() < 1e-9
    # nose up is a negative pitch; the slope of the road is s/v, half the wheelbase behind
    slow = 2j * np.pi * 0.01
    assert response[0, 6, 0] == pytest.approx(1.0, abs=0.02)
    assert -response[0, 6, 1] == pytest.approx(slow / 10.0, rel=0.05)


def test_profile_as_driven_over_a_wavy_road(tmp_path):
    """Waves of 10 m and 20 µm at 20 m/s: slope and delay of the rear wheels as in the run."""
    scenario = ROOT / "scenarios/iltis_sine_steer.yaml"
    steered = scenario.read_text(encoding="utf-8")
    text = steered.replace("amplitude: 2 mm", "amplitude: 0 mm")
    text = text.replace("duration: 3 s", "duration: 6 s").replace("start: static", "start: steady")
    waves = "sine, amplitude_x: 20 um, wavelength_x: 10 m, amplitude_y: 0 m, wavelength_y: 10 m"
    text = text.replace("road:\n  kind: flat", f"road: {{kind: {waves}}}")
    simulated(text, tmp_path, 2.0)
    with open_result(tmp_path / "drive.h5") as result:
        table = result.as_frame()
    table = table[table.index > table.index[-1] - 1.5]
    speed = float(table["chassis.x_rate"].mean())
    names = ["accelerometer.vertical", "chassis.z", "chassis.pitch"]
    linear = respond(
        load_scenario(scenario), "profile", names, at=[speed / 10.0], speed=speed
    ).response_at[0, 0]
    place = table["wheel_fl.contact_x"].to_numpy()
    for name, expected in zip(names, linear, strict=True):
        found = fitted(place, table[name].to_numpy(), 0.1)
        assert abs(found / 20e-6 / expected - 1.0) < 2e-5


def test_a_profile_needs_a_speed():
    with pytest.raises(InputError, match="a road is run over at a speed; give speed"):
        respond(load_model("iltis"), "profile", "chassis.z")


@pytest.mark.parametrize(
    ("given", "output", "words"),
    [
        ("body.height", "body.height", "inputs='body.height': 'body.height' is free.*'force:body"),
        ("base.heigt", "body.height", "inputs='base.heigt': the model has no such input; did you"),
        ("force:bdy", "body.height", "there is no coordinate 'bdy'"),
        ("wrench:body", "body.height", "write wrench:BODY.COMPONENT"),
        ("wrench:bod.force_x", "body.height", "there is no body 'bod'; did you mean 'body'"),
        ("wrench:body.force_x@1,b", "body.height", "'@1,b' is no point"),
        ("parameter:mas", "body.height", "there is no parameter 'mas'; did you mean 'mass'"),
        ("road", "body.height", "the model has no wheels"),
        ("base.height", "body.heigt", "outputs='body.heigt': there is no such channel; did you"),
    ],
)
def test_unusable_names_are_told(system, given, output, words):
    with pytest.raises(InputError, match=words):
        respond(system(SUSPENDED), given, output)


def test_parameters_that_move_bodies_or_loops_are_refused(system):
    four_bar = load_model(str(ROOT / "systems/four_bar.yaml"))
    with pytest.raises(InputError, match=r"parameter:crank.length': the parameter (moves|changes)"):
        respond(four_bar, "parameter:crank.length", "rocker.angle")
    with pytest.raises(
        InputError, match=r"parameter:rocker.length': the parameter changes the loops"
    ):
        respond(four_bar, "parameter:rocker.length", "rocker.angle")
