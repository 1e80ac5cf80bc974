"""Disc brakes with anti-lock and yaw control as a part: energy, distribution, sampled laws."""

from pathlib import Path

import numpy as np
import pytest

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.base.errors import InputError
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive
from vehicledyn.road.manoeuvres.foot import LAG, Foot

SYSTEMS = Path(__file__).parents[3] / "systems"
WHEELS = ("front_left", "front_right", "rear_left", "rear_right")


class Brakes:
    """The part with its four flywheels."""

    def __init__(self):
        model, problems = read_system(SYSTEMS / "controlled_brakes.yaml", {})
        assert not problems
        self.p = model.resolved
        self.equations = derive(build_system(model))
        self.kernel = compile_kernel(self.equations, backend="interpreted")
        self.names = [s.name for s in self.equations.states]

    def state(self, given):
        assert given.keys() <= set(self.names)
        return np.array([given.get(s.name, s.start) for s in self.equations.states])

    def at(self, given):
        """Return rates and channels by name."""
        e, x = self.equations, self.state(given)
        z = assemble(self.kernel, 0.0, x, np.array([u.start for u in e.unknowns]))
        rates, outputs = self.kernel.rates(0.0, x, z), self.kernel.outputs(0.0, x, z)
        found = {f"d.{s.name}": v for s, v in zip(e.states, rates, strict=True)}
        return found | {c.name: v for c, v in zip(e.channels, outputs, strict=True)}


@pytest.fixture(scope="module")
def brakes():
    return Brakes()


@pytest.mark.parametrize("seed", range(4))
def test_power_goes_into_stored_energy_and_a_loss(brakes, seed):
    """d(kinetic)/dt + d(stored)/dt = -loss, loss = T ω - k s z' of each disc, never negative."""
    draw, p = np.random.default_rng(seed), brakes.p
    given = {"pedal.value": draw.uniform()}
    for wheel in WHEELS:
        given[f"{wheel}.spin_rate"] = draw.normal(scale=30.0)
        given[f"{wheel}_disc.twist"] = draw.normal(scale=0.04)
        given[f"{wheel}_valve.value"] = draw.uniform()
    seen, balance, size = brakes.at(given), 0.0, 0.0
    for wheel in WHEELS:
        front = wheel.startswith("front")
        share = p["brake.front_share"] if front else 1.0 - p["brake.front_share"]
        applied = min(given["pedal.value"], given[f"{wheel}_valve.value"])
        most = applied * p["brake.torque"] * share / 2.0
        spin, twist = given[f"{wheel}.spin_rate"], given[f"{wheel}_disc.twist"]
        stiffness = p["brake.stiffness"]
        torque = np.clip(stiffness * twist + p["brake.damping"] * spin, -most, most)
        stuck = np.clip(twist, -most / stiffness, most / stiffness)
        stored = stiffness * stuck * seen[f"d.{wheel}_disc.twist"]
        loss = torque * spin - stored
        assert seen[f"{wheel}_disc.torque"] == pytest.approx(torque, rel=1e-12)
        assert loss >= -1e-9
        kinetic = p["flywheel.inertia"] * spin * seen[f"d.{wheel}.spin_rate"]
        balance += kinetic + stored + loss
        size += abs(kinetic) + abs(stored) + loss
    assert abs(balance) <= 1e-9 * size


def _sampled(brakes, given):
    """Return what a sample makes of the switches, by name, one event after the other."""
    x = brakes.state(given)
    z = np.array([u.start for u in brakes.equations.unknowns])
    found = {}
    for event in brakes.equations.events:
        values = brakes.kernel.reset_values(0.0, x, z)
        for state, row in event.resets:
            x[state] = found[brakes.names[state]] = values[row]
    return found


def _wheels(p, speed, **slips):
    """Return spin rates at a speed [m/s] with these slips."""
    radius = p["wheel_radius"]
    return {f"{w}.spin_rate": speed * (1.0 - slips.get(w, 0.0)) / radius for w in WHEELS}


def test_anti_lock_releases_holds_and_builds_up(brakes):
    p = brakes.p
    given = {f"{w}_valve.value": 0.5 for w in WHEELS} | {"pedal.value": 1.0}
    slips = {"front_left": 0.3, "front_right": 0.1, "rear_left": 0.05}
    given |= {"reference.value": 20.0, "sample.value": 7.0}
    found = _sampled(brakes, given | _wheels(p, 20.0, **slips))
    step = p["sampling"]
    assert found["sample.value"] == 8.0
    second_highest = 0.95 * 20.0
    fastest_fall = 20.0 - p["anti_lock.slowing"] * step
    assert found["reference.value"] == pytest.approx(max(second_highest, fastest_fall))
    assert found["front_left_valve.value"] == pytest.approx(0.5 - p["anti_lock.fall"] * step)
    assert found["front_right_valve.value"] == pytest.approx(0.5)
    assert found["rear_left_valve.value"] == pytest.approx(0.5 + p["anti_lock.rise"] * step)
    locked = _wheels(p, 20.0, **dict.fromkeys(WHEELS, 1.0))
    fallen = _sampled(brakes, given | locked)["reference.value"]
    assert fallen == pytest.approx(20.0 - p["anti_lock.slowing"] * step)
    slow = _sampled(brakes, given | {"reference.value": 1.0} | _wheels(p, 1.0, front_left=1.0))
    assert slow["front_left_valve.value"] == 1.0


def _turning(p, speed, across, rate, angle):
    """Return the speed of each wheel along its own plane: v + ω × r at its place [m/s]."""
    found = {}
    for wheel in WHEELS:
        aside = p["wheels.aside"] * (1.0 if wheel.endswith("left") else -1.0)
        front = wheel.startswith("front")
        at = np.array([speed - rate * aside, across + rate * p["wheels.ahead"]])
        plane = np.array([np.cos(angle), np.sin(angle)]) if front else np.array([1.0, 0.0])
        found[wheel] = float(at @ plane)
    return found


def test_wheels_that_roll_freely_in_a_slide_have_no_slip(brakes):
    """A steered wheel turned by 0.4 rad from its way rolls 8 % slower, and is not released."""
    p, speed, across, rate, angle = brakes.p, 18.0, 5.0, -0.8, -0.25
    rolling = _turning(p, speed, across, rate, angle)
    radius, turn = p["wheel_radius"], 0.6
    given = {f"{w}.spin_rate": v / radius for w, v in rolling.items()}
    given |= {"reference.value": speed, "across.value": across, "chassis.yaw_rate": rate}
    given |= {"rack.displacement": angle / p["wheels.steering_gain"], "chassis.yaw": turn}
    given["chassis.x_rate"] = speed * np.cos(turn) - across * np.sin(turn)
    given["chassis.y_rate"] = speed * np.sin(turn) + across * np.cos(turn)
    found = _sampled(brakes, given)
    assert found["across.value"] == pytest.approx(across, rel=1e-12)
    assert found["sideslip.value"] == pytest.approx(np.arctan2(across, speed), rel=1e-12)
    for wheel, along in rolling.items():
        assert found[f"{wheel}_says.value"] == pytest.approx(speed, rel=1e-12)
        assert found[f"{wheel}_rolls.value"] == pytest.approx(along, rel=1e-12)
    braked = given | {f"{w}_valve.value": 0.5 for w in WHEELS} | {"pedal.value": 1.0}
    for wheel in ("front_left", "rear_right"):
        slip = 0.5 * (p["anti_lock.build"] + p["anti_lock.release"])
        braked[f"{wheel}.spin_rate"] *= 1.0 - slip
    after = _sampled(brakes, braked)
    assert after["front_left_valve.value"] == 0.5
    assert after["front_right_valve.value"] > 0.5
    assert after["rear_left_valve.value"] == after["rear_right_valve.value"] == 0.5
    spinning = given | {"rear_right.spin_rate": 1.5 * speed / radius}
    assert _sampled(brakes, spinning)["reference.value"] == pytest.approx(speed, rel=1e-12)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_yaw_control_brings_a_sideslip_angle_back(brakes, side):
    """Beyond the bound the yaw rate wanted grows by the return rate times what is beyond."""
    p, speed = brakes.p, 20.0
    given = {"reference.value": speed} | _wheels(p, speed)
    for angle, beyond in ((0.5 * p["yaw_control.sideslip"], 0.0), (0.3, None)):
        wanted = angle - p["yaw_control.sideslip"] if beyond is None else beyond
        seen = _sampled(brakes, given | {"across.value": side * speed * np.tan(angle)})
        error = -side * p["yaw_control.return_rate"] * wanted
        assert seen["yaw_error.value"] == pytest.approx(error, abs=1e-12)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_yaw_control_brakes_against_the_error(brakes, side):
    """Wanted is v δ/(l (1 + v²/v_ch²)) within friction; what exceeds it brakes the outer front."""
    p, speed = brakes.p, 20.0
    angle = side * 0.02
    given = {"reference.value": speed, "rack.displacement": angle / p["yaw_control.steering_gain"]}
    wanted = speed * angle / p["yaw_control.wheelbase"]
    wanted /= 1.0 + (speed / p["yaw_control.characteristic_speed"]) ** 2
    rolling = _turning(p, speed, 0.0, wanted + side * 0.2, angle)
    given |= {f"{w}.spin_rate": along / p["wheel_radius"] for w, along in rolling.items()}
    seen = _sampled(brakes, given | {"chassis.yaw_rate": wanted + side * 0.2})
    assert seen["yaw_error.value"] == pytest.approx(side * 0.2, rel=1e-9)
    after = given | {"chassis.yaw_rate": wanted, "yaw_error.value": side * 0.2}
    demand = p["yaw_control.gain"] * (0.2 - p["yaw_control.dead_band"])
    seen = _sampled(brakes, after)
    assert seen["front_correction.value"] == pytest.approx(side * demand, rel=1e-9)
    assert seen["rear_correction.value"] == 0.0
    seen = _sampled(brakes, after | {"yaw_error.value": -side * 0.2})
    assert seen["rear_correction.value"] == pytest.approx(-side * demand, rel=1e-9)
    steep = {"rack.displacement": side * 0.6 / p["yaw_control.steering_gain"]}
    rolling = _turning(p, speed, 0.0, 0.0, side * 0.6)
    steep |= {f"{w}.spin_rate": along / p["wheel_radius"] for w, along in rolling.items()}
    seen = _sampled(brakes, given | steep | {"chassis.yaw_rate": 0.0})
    bound = p["yaw_control.friction"] * 9.81 / speed
    assert seen["yaw_error.value"] == pytest.approx(-side * bound, rel=1e-9)


def test_a_foot_reaches_what_is_wanted_with_its_lag():
    class Seen:
        time, states = 0.0, {"value": 0.25}

    foot = Foot("pedal", lambda _: 3.0)
    assert float(foot.loads(Seen()).rates["value"]) == pytest.approx((1.0 - 0.25) / LAG)


def test_a_pedal_names_a_switch(tmp_path):
    from vehicledyn.files.building.construct import build_vehicle
    from vehicledyn.files.building.road_choice import RoadChoice

    text = (SYSTEMS / "controlled_sedan.yaml").read_text().replace("brakes.pedal", "brakes.pdal")
    text = text.replace("file: ", f"file: {SYSTEMS}/")
    path = tmp_path / "car.yaml"
    path.write_text(text, encoding="utf-8")
    model, _ = read_system(path, {})
    with pytest.raises(InputError, match=r"did you mean 'brakes\.pedal'"):
        build_vehicle(model, RoadChoice())
