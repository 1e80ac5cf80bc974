"""The manual gearbox with its driver: energy at random states, a standing start and its shifts."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

FILE = Path(__file__).parents[3] / "systems" / "manual_gearbox.yaml"
RATIOS = 1.0 / np.array([0.265, 0.489, 0.784, 1.063, 1.276, 1.499])
ENGINE, INPUT, FLYWHEEL = 0.2, 0.03, 7.3
CLUTCH, GEARS = (600.0, 3e3), (1500.0, 6e3)
SYNCHRONISER = 80.0


@pytest.fixture(scope="module")
def part():
    model, problems = read_system(FILE, {})
    assert not problems
    e = derive(build_system(model))
    kernel = compile_kernel(e, backend="interpreted")

    def at(time, given):
        assert given.keys() <= {s.name for s in e.states}, [s.name for s in e.states]
        x = np.array([given.get(s.name, s.start) for s in e.states])
        z = assemble(kernel, time, x, np.array([u.start for u in e.unknowns]))
        rates, outputs = kernel.rates(time, x, z), kernel.outputs(time, x, z)
        found = {f"d.{s.name}": v for s, v in zip(e.states, rates, strict=True)}
        return found | {c.name: v for c, v in zip(e.channels, outputs, strict=True)}

    return at


def pedal(since, speed):
    """Return how far the clutch is closed: by the foot and by the engine's speed."""
    foot = min(1.0, max(1.0 - since / 0.1, 0.0, (since - 0.35) / 0.3))
    return foot * min(max((speed - 100.0) / 150.0, 0.0), 1.0)


@pytest.mark.parametrize("seed", range(12))
def test_power_of_the_engine_is_growth_of_energy_and_losses(part, seed):
    """Each coupling passes at most its limit, stores ½ k z² and loses T ω - k z z' ≥ 0."""
    draw = np.random.default_rng(seed)
    speed, since = float(draw.uniform(20.0, 500.0)), float(draw.uniform(0.0, 0.9))
    inner, outer = speed + float(draw.normal(scale=40.0)), float(draw.uniform(0.0, 150.0))
    gear, engaged, synchronised = draw.integers(1, 7), draw.integers(0, 2), draw.integers(0, 2)
    most = CLUTCH[0] * pedal(since, speed)
    held = engaged * (GEARS[0] if synchronised else SYNCHRONISER)
    twists = [float(draw.uniform(-1.0, 1.0)) * m / k for m, k in ((most, 3e3), (held, 6e3))]
    found = part(
        5.0,
        {
            "engine.angle_rate": speed,
            "input.angle_rate": inner,
            "propeller.angle_rate": outer,
            "clutch.twist": twists[0],
            "gearbox.twist": twists[1],
            "changed_at.value": 5.0 - since,
            "gear.value": float(gear),
            "engaged.value": float(engaged),
            "synchronised.value": float(synchronised),
        },
    )
    ratio = RATIOS[gear - 1]
    passed, geared = found["clutch.torque"], found["gearbox.torque"]
    assert passed == pytest.approx(
        np.clip(3e3 * twists[0] + 8.0 * (speed - inner), -most, most), rel=1e-9, abs=1e-9
    )
    assert abs(geared) <= held * (1.0 + 1e-12)
    rates = [found[f"d.{n}.angle_rate"] for n in ("engine", "input", "propeller")]
    expected = [
        (found["engine.torque"] - passed) / ENGINE,
        (passed - geared) / INPUT,
        ratio * geared / FLYWHEEL,
    ]
    assert rates == pytest.approx(expected, rel=1e-9, abs=1e-9)
    stored = [k * z * found[f"d.{n}.twist"] for n, k, z in zip(
        ("clutch", "gearbox"), (3e3, 6e3), twists, strict=True
    )]  # fmt: skip
    losses = [found["clutch.power"] - stored[0], found["gearbox.power"] - stored[1]]
    assert min(losses) >= -1e-9 * max(map(abs, stored))
    kinetic = ENGINE * speed * rates[0] + INPUT * inner * rates[1] + FLYWHEEL * outer * rates[2]
    size = abs(found["engine.power"]) + abs(kinetic) + sum(losses)
    assert kinetic + sum(stored) + sum(losses) - found["engine.power"] == pytest.approx(
        0.0, abs=1e-9 * size
    )


@pytest.mark.long
def test_the_driver_starts_from_rest_and_changes_up(tmp_path):
    path = tmp_path / "start.yaml"
    path.write_text(
        f"title: Start\nmodel: {FILE}\nduration: 4 s\n"
        "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 1 ms}\n",
        encoding="utf-8",
    )
    run = vd.simulate(path)
    engine, inner, outer = (
        np.asarray(run[f"{n}.angle_rate"]) for n in ("engine", "input", "propeller")
    )
    selected, time = np.asarray(run["selected"]), np.asarray(run.time)
    changes = selected[np.flatnonzero(np.diff(selected)) + 1]
    assert changes.tolist() == [0.0, 2.0, 0.0, 3.0]
    assert engine.min() > 80.0
    assert engine.max() < 500.0
    assert np.diff(outer).min() > -1e-3 * outer.max()
    assert inner[0] == 0.0
    for at, gear in ((0.8, 1), (2.2, 2), (4.0, 3)):
        now = int(np.argmin(np.abs(time - at)))
        assert selected[now] == gear
        assert engine[now] == pytest.approx(inner[now], rel=1e-3)
        assert inner[now] == pytest.approx(RATIOS[gear - 1] * outer[now], rel=1e-3)
    kinetic = 0.5 * (ENGINE * engine**2 + INPUT * inner**2 + FLYWHEEL * outer**2)
    given, lost = (
        np.trapezoid(sum(np.asarray(run[name]) for name in names), time)
        for names in (["engine.power"], ["clutch.power", "gearbox.power"])
    )
    stored = 0.5 * (
        3e3 * run["clutch.twist"].values[-1] ** 2 + 6e3 * run["gearbox.twist"].values[-1] ** 2
    )
    assert lost - stored > 10e3
    assert kinetic[-1] - kinetic[0] == pytest.approx(given - lost, rel=2e-3)
