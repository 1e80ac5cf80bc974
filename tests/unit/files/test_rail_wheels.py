"""Wheels on rails in a system: forces, symmetry, power, lift, derailment, messages."""

from pathlib import Path

import casadi
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model
from vehicledyn.multibody.equations.derivation import equations_of, solve_motion

WHEELSET = Path(__file__).parents[3] / "systems" / "rail_wheelset.yaml"
SIDES = ("left", "right")
TURNED = ("lateral", "yaw", "roll")


class Wheelset:
    """Rates, channels, events and Jacobian of the wheelset as functions of named states."""

    def __init__(self):
        self.subject = build_subject(load_model(str(WHEELSET)))
        e = equations_of(solve_motion(self.subject.system))
        self.names = [s.name.removeprefix("wheelset.") for s in e.states]
        self.start = np.array([s.start for s in e.states])
        values = casadi.DM([p.value for p in e.parameters])
        given = [e.state]
        rate, output, event = casadi.substitute(
            [e.rate, e.output, e.event], [e.time, e.parameter], [casadi.SX(0.0), casadi.SX(values)]
        )
        self.numbers = {p.name: p.value for p in e.parameters}
        self._rate = casadi.Function("rate", given, [rate])
        self._event = casadi.Function("event", given, [event])
        self._output = casadi.Function("output", given, [output])
        self.channel_names = [c.name for c in e.channels]
        self.event_names = [x.name for x in e.events]

    def state(self, **values):
        state = np.where(np.char.endswith(self.names, "_rate"), self.start, 0.0)
        for name, value in values.items():
            state[self.names.index(name)] = value
        return state

    def rates(self, state):
        return dict(zip(self.names, np.array(self._rate(state)).ravel(), strict=True))

    def channels(self, state):
        return dict(zip(self.channel_names, np.array(self._output(state)).ravel(), strict=True))

    def events(self, state):
        return dict(zip(self.event_names, np.array(self._event(state)).ravel(), strict=True))


@pytest.fixture(scope="module")
def wheelset():
    return Wheelset()


def somewhere(wheelset, rng):
    return wheelset.state(
        lateral=rng.uniform(-6.5e-3, 6.5e-3),
        vertical=rng.uniform(-4e-4, -2e-4),
        yaw=rng.normal() * 5e-3,
        roll=rng.normal() * 1e-4,
        longitudinal_rate=rng.normal() * 0.1,
        lateral_rate=rng.normal() * 0.05,
        vertical_rate=rng.normal() * 0.01,
        yaw_rate=rng.normal() * 0.05,
        roll_rate=rng.normal() * 0.02,
        spin_rate=43.5 + rng.normal() * 0.2,
    )


@pytest.mark.parametrize("seed", range(4))
def test_mirror_image_moves_as_mirror_image(wheelset, seed):
    state = somewhere(wheelset, np.random.default_rng(seed))
    signs = np.array([-1.0 if n.removesuffix("_rate") in TURNED else 1.0 for n in wheelset.names])
    own, mirrored = wheelset.rates(state), wheelset.rates(signs * state)
    for name, sign in zip(wheelset.names, signs, strict=True):
        assert mirrored[name] == pytest.approx(sign * own[name], rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("seed", range(4))
def test_contact_forces_move_the_wheelset(wheelset, seed):
    """Newton's second law with the forces that the channels tell."""
    state = somewhere(wheelset, np.random.default_rng(10 + seed))
    found, rates, numbers = wheelset.channels(state), wheelset.rates(state), wheelset.numbers
    across = -sum(found[f"wheels.{side}.Y"] for side in SIDES) + found["lateral.force"]
    assert numbers["mass"] * rates["lateral_rate"] == pytest.approx(across, rel=1e-9)
    up = sum(found[f"wheels.{side}.Q"] for side in SIDES) - numbers["wheelset_load"]
    assert numbers["mass"] * rates["vertical_rate"] == pytest.approx(up, rel=1e-9)
    assert max(found[f"wheels.{side}.Q"] for side in SIDES) > 0.0


@pytest.mark.parametrize("seed", range(4))
def test_creep_dissipates_and_is_told(wheelset, seed):
    found = wheelset.channels(somewhere(wheelset, np.random.default_rng(20 + seed)))
    for side in SIDES:
        worn = 0.0
        for n in (1, 2):
            at = {
                key.rpartition(".")[2]: value
                for key, value in found.items()
                if key.startswith(f"wheels.{side}.contact_{n}.")
            }
            parts = (
                at["longitudinal_force"] * at["longitudinal_creepage"],
                at["lateral_force"] * at["lateral_creepage"],
                at["spin_moment"] * at["spin_creepage"],
            )
            assert sum(parts) <= 0.0
            tangential = np.hypot(at["longitudinal_force"], at["lateral_force"])
            assert tangential <= 0.3 * at["normal_force"] * (1.0 + 1e-9)
            worn += sum(map(abs, parts))
        assert found[f"wheels.{side}.wear_number"] == pytest.approx(worn, rel=1e-12)


def test_spin_is_turned_by_longitudinal_creep(wheelset):
    """A wheelset that spins too fast in the middle is braked by both contacts at their radius."""
    state = wheelset.state(lateral=0.0, vertical=-3e-4, spin_rate=44.5)
    found, rates = wheelset.channels(state), wheelset.rates(state)
    torque = 0.0
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        head = f"wheels.{side}.contact_1."
        torque -= sign * found[f"{head}spin_moment"] * np.sin(found[f"{head}angle"])
        torque -= found[f"{head}longitudinal_force"] * found[f"{head}rolling_radius"]
        slip = 1.0 - 44.5 * found[f"{head}rolling_radius"] / 20.0
        assert found[f"{head}longitudinal_creepage"] == pytest.approx(slip, rel=1e-6)
    assert wheelset.numbers["spin_inertia"] * rates["spin_rate"] == pytest.approx(torque, rel=1e-9)
    assert torque < 0.0


def test_damping_adds_to_the_force_as_stated(wheelset):
    """N (1 + d δ̇) with d = 2 s/m, at a wheelset that comes down at 20 mm/s; none that pulls."""
    still, down, up = (
        wheelset.channels(
            wheelset.state(lateral=0.0, vertical=-3e-4, vertical_rate=rate, spin_rate=43.5)
        )
        for rate in (0.0, -0.02, 1.0)
    )
    name = "wheels.left.contact_1.normal_force"
    angle = still["wheels.left.contact_1.angle"]
    assert down[name] == pytest.approx(still[name] * (1.0 + 2.0 * 0.02 * np.cos(angle)), rel=1e-9)
    assert up[name] == 0.0


def test_a_lifted_wheelset_falls(wheelset):
    state = wheelset.state(vertical=0.02, yaw=0.01)
    found, rates = wheelset.channels(state), wheelset.rates(state)
    assert all(np.isfinite(list(found.values())))
    assert [found[f"wheels.{side}.Q"] for side in SIDES] == [0.0, 0.0]
    load = wheelset.numbers["wheelset_load"] / wheelset.numbers["mass"]
    assert rates["vertical_rate"] == pytest.approx(-load, rel=1e-12)


@pytest.mark.parametrize(
    ("lateral", "vertical", "derailed"),
    [
        (0.0, 0.0, set()),
        (8e-3, 1e-3, set()),
        (0.045, 0.03, {"wheels.left.derailed"}),
        (-0.045, 0.03, {"wheels.right.derailed"}),
        (0.12, 0.0, {"wheels.left.derailed", "wheels.right.derailed"}),
    ],
)
def test_derailment_is_an_event(wheelset, lateral, vertical, derailed):
    """Over one rail with the flange; far over it the other wheel is between the rails."""
    found = wheelset.events(wheelset.state(lateral=lateral, vertical=vertical))
    assert {name for name, value in found.items() if value > 0.0} == derailed


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "creep: {kind: shen_hedrick_elkins, friction: 0.3}\n",
            "",
            "creep: missing: the system runs on rails",
        ),
        ("profile: S1002", "profile: S1003", "did you mean 'S1002'"),
        ("wheels: [left, right]", "wheels: [left, left]", "name one side or both"),
        ("tape_circle: tape_circle", "tape_circle: mass", "tape_circle: this is in kg"),
        ("gauge: 1435 mm", "gauge: 1668 mm", "the gauge does not fit: tape circles 1500 mm apart"),
        ("gauge: 1435 mm", "gauge: 1415 mm", "in the middle of the track the left flange is on"),
        ("track: {kind", "road: {kind: flat}\nx: {kind", "x: unknown"),
    ],
)
def test_mistakes_are_told(tmp_path, old, new, words):
    text = WHEELSET.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "wrong.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        build_subject(load_model(str(path)))
