"""Cycles whose second half is the mirror image of the first are found by half of their motion."""

import math

import numpy as np
import pytest
from cycle_examples import field, from_hopf, grazing_oscillator, sampled_orbit
from solve_examples import build, symbols

from vehicledyn.analyse.periodic import autonomous
from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.cycle_points import Limits
from vehicledyn.analyse.periodic.mirror_symmetry import mirror_of, mirrored_mesh


@pytest.fixture
def compiled(needs_compiler, monkeypatch):
    """Small fields are compiled; told are the times through which motions are followed."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    exact, asked = AutonomousField.followed, []

    def told(self, state, value, durations, **options):
        asked.append(durations.sum())
        return exact(self, state, value, durations, **options)

    monkeypatch.setattr(AutonomousField, "followed", told)
    return asked


def circle_that_breaks():
    """The circle r = 1 in 2π, beside it u = x + w, where w' = w (μ - w²) and z² = 1 for ever.

    In the mirror -x, -y, -u, z; from μ = 0 on cycles with w = ±√μ branch off, of which each is the
    image of the other.
    """
    t, x, y, u, z, m = symbols("t", "x", "y", "u", "z", "mu")
    r2, w = x * x + y * y, u - x
    turn = x * (1 - r2) - y
    return build(
        "breaking", time=t, states=[(x, 1.0), (y, 0.0), (u, 1.0), (z, 1.0)],
        rates=[turn, y * (1 - r2) + x, turn + w * (m - w * w), 1.0 - z**3 + 0.1 * w * x],
        parameters=[(m, -0.5)], outputs=[("x", x)],
    )  # fmt: skip


def on_circle(s):
    x, y = np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)
    return np.column_stack([x, y, x, np.ones_like(x)])


def test_the_mirror_is_kept_where_cycles_that_break_it_branch_off(compiled):
    model = field(circle_that_breaks(), "mu")
    start = sampled_orbit(2.0 * math.pi, -0.5, on_circle, intervals=11)
    branch = follow_cycles(model, start, None, Limits(-0.6, 0.5, 0.1))
    (found,) = branch.special
    assert found.kind == "branch_point" and branch.ending == "range"
    assert found.orbit.parameter == pytest.approx(0.0, abs=1e-5)
    assert max(compiled[2:]) < 1.001 * math.pi
    assert len({p.sense for p in branch.points[:-1]}) == 1 and branch.points[0].sense
    for point in branch.points:
        orbit = point.orbit
        half = len(orbit.states) // 2
        assert orbit.states[half:] == pytest.approx(orbit.states[:half] * [-1, -1, -1, 1], abs=1e-9)
        assert np.hypot(*orbit.states[:, :2].T) == pytest.approx(1.0, abs=1e-6)
        expected = np.exp(2.0 * np.pi * np.array([orbit.parameter, -2.0, -3.0]))
        assert np.sort(point.multipliers.others.real)[::-1] == pytest.approx(
            np.sort(expected)[::-1], rel=1e-3, abs=1e-5
        )
        assert point.multipliers.trivial == pytest.approx(1.0, abs=5e-4)


@pytest.mark.long
def test_cycles_of_one_side_are_followed_as_a_whole(compiled):
    """The stop on one side is touched far from where the cycles begin, as their own image."""
    model = field(grazing_oscillator(), "mu")
    _, branch = from_hopf(model, -0.1, 0.04, amplitude=1e-2, points=15)
    first, *_, last = branch.points[:-1]
    assert first.passages.mirror is not None and last.passages.mirror is None
    for point in branch.points[:-1]:
        if point.passages.mirror is not None:
            assert np.abs(point.orbit.states[:, 0]).max() < 1.01


def sides(even):
    """Oscillators on the left and the right that grow while they swing against each other."""
    t, a, da, b, db, m = symbols("t", "a", "da", "b", "db", "mu")
    rates = []
    for own, rate, other in ((a, da, db), (b, db, da)):
        growth = (m - own * own) * (rate - other) - 0.5 * (rate + other)
        rates += [rate, -own - even * own * own + growth]
    return build(
        "sides", time=t, states=[(a, 0.0), (da, 0.0), (b, 0.0), (db, 0.0)], rates=rates,
        parameters=[(m, 0.0)], outputs=[("a", a)], positions=(0, 2), velocities=(1, 3),
    )  # fmt: skip


@pytest.mark.parametrize(("even", "order"), [(0.0, [0, 1, 2, 3]), (0.2, [2, 3, 0, 1])])
def test_left_and_right_are_exchanged_where_they_must_be(compiled, even, order):
    model = field(sides(even), "mu")
    _, branch = from_hopf(model, -0.05, 0.05, amplitude=1e-3)
    mirror = branch.points[-2].passages.mirror
    assert list(mirror.order) == order
    assert list(mirror.factors) == [1.0 if even else -1.0] * 4
    last = branch.points[-1].orbit
    assert last.parameter == 0.05
    later = last.sample((np.linspace(0, 1, 9) + 0.5) % 1.0)[0]
    assert later == pytest.approx(mirror.image(last.sample(np.linspace(0, 1, 9))[0]), abs=1e-6)


def test_there_is_no_mirror_where_rates_or_orbits_have_none(needs_compiler, monkeypatch):
    monkeypatch.setattr(autonomous, "LEAST", 0)
    t, x, v, m = symbols("t", "x", "v", "mu")

    def equations(beside):
        return build(
            "leaning", time=t, states=[(x, 0.0), (v, 0.0)], rates=[v, -x + m * v + beside],
            parameters=[(m, 0.0)], outputs=[("x", x)],
        )  # fmt: skip

    orbit = sampled_orbit(
        2.0 * math.pi, 0.0,
        lambda s: 1e-3 * np.column_stack([np.cos(2 * np.pi * s), -np.sin(2 * np.pi * s)]),
    )  # fmt: skip
    assert mirror_of(field(equations(0.0), "mu"), orbit, [0.0, 1.0]) is not None
    assert mirror_of(field(equations(1e-2 * x * x), "mu"), orbit, [0.0]) is None
    assert mirror_of(field(equations(m * x * x), "mu"), orbit, [0.0]) is not None
    assert mirror_of(field(equations(m * x * x), "mu"), orbit, [0.0, 1.0]) is None
    lopsided = sampled_orbit(
        2.0 * math.pi, 0.0,
        lambda s: np.column_stack([np.cos(2 * np.pi * s) + 0.01 * np.cos(4 * np.pi * s), s * 0.0]),
    )  # fmt: skip
    assert mirror_of(field(equations(0.0), "mu"), lopsided, [0.0]) is None


@pytest.mark.parametrize("count", [10, 11])
def test_a_mesh_is_its_own_image(count):
    mesh = np.linspace(0.0, 1.0, count + 1) ** 2
    found = mirrored_mesh(mesh)
    middle = (len(found) - 1) // 2
    assert found[0] == 0.0 and found[middle] == 0.5 and found[-1] == 1.0
    assert (np.diff(found) > 0.0).all() and len(found) in (count + 1, count + 2)
    assert found[middle:] - 0.5 == pytest.approx(found[: middle + 1], abs=1e-15)


def test_rounding_in_a_rate_that_is_none_breaks_no_mirror(compiled):
    """A wheel that would turn evenly: its rate is the rounding of terms that cancel."""
    t, x, v, w, m = symbols("t", "x", "v", "w", "mu")
    turning = (w + 0.3 * x) - w - 0.3 * x + 1e-13 * (w - 1.0)
    equations = build(
        "turning", time=t, states=[(x, 0.0), (v, 0.0), (w, 1.0)],
        rates=[v, -x + (m - x * x) * v, turning + 1e-16 * x], parameters=[(m, 0.0)],
        outputs=[("x", x)],
    )  # fmt: skip
    model = field(equations, "mu")
    orbit = sampled_orbit(
        2.0 * math.pi, 0.0,
        lambda s: np.column_stack(
            [np.cos(2 * np.pi * s), -np.sin(2 * np.pi * s), np.ones_like(s)]
        ),
    )  # fmt: skip
    mirror = mirror_of(model, orbit, [0.0])
    assert mirror is not None and list(mirror.factors) == [-1.0, -1.0, 1.0]
