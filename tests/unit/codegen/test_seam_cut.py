"""A model cut from its surroundings computes the same, and is compiled once for all of them."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from solve_examples import build, starts, symbols
from table_examples import height, quintic

from vehicledyn.codegen.passes import seam_cut
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.kernel import seam_library
from vehicledyn.kernel.lanes import compile_lanes
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic.equations import Block, Event, Seam, with_tables

TIME = 0.3


@pytest.fixture(autouse=True)
def cuts_small_models(monkeypatch):
    monkeypatch.setattr(seam_cut, "_LARGE", 1)


@pytest.fixture
def folder(tmp_path, monkeypatch, needs_compiler):
    """An empty cache of this test."""
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def cart(driver, *, mass=1.3):
    """A mass on a curve with a loop, pushed by a driver who sees it and moves its support."""
    t, x, v, w, k, m, gain = symbols("t", "x", "v", "w", "k", "m", "driver.gain")
    ground, seen = height(), quintic()
    states, rates, *values = driver(t, x, v, gain, seen)
    support, push = handed = symbols("support", "push")
    residual = w + 0.2 * w**3 - seen.value(x + 0.5 * w) - 0.1 * support
    force = push / m - ground.slope(x) * ca.cos(x) - (k + ca.sin(k)) * (x - support)
    equations = build(
        "cart",
        time=t,
        states=[(x, 0.4), (v, 1.0), *states],
        rates=[v, force / m - 0.1 * w * v, *rates],
        parameters=[(k, 0.7), (m, mass), (gain, 2.0)],
        unknowns=[(w, 0.1)],
        residuals=[residual],
        outputs=[
            ("driver.error", x - seen.value(t)),
            ("power", push * v),
            ("height", ground.value(x) + w),
            ("driver.support", support),
        ],
        blocks=(Block("loop", 0, 1, 1e-10),),
        events=(Event("top", 0, "rising", resets=((1, 0),)),),
    )
    opened = replace(
        equations, event=ca.vertcat(x - 0.9 - support), reset=ca.vertcat(-0.5 * v + push)
    )
    names = ("rate", "residual", "output", "event", "reset")
    column, given = ca.vertcat(*handed), ca.vertcat(*values)
    columns = ca.substitute([getattr(opened, name) for name in names], [column], [given])
    seam = Seam(("support", "push"), column, given, ("driver",), opened)
    return with_tables(replace(opened, seam=seam, **dict(zip(names, columns, strict=True))))


def hurried(t, x, v, gain, seen):
    """Push by the error, support at rest in a state of its own."""
    (lag,) = symbols("driver.lag")
    push = gain * (seen.value(t) - x) - ca.sin(gain) * lag * v
    return [(lag, 0.2)], [push - lag], ca.sin(lag), push


def firm(*given):
    """Push otherwise."""
    states, rates, support, push = hurried(*given)
    return states, [2.0 * rates[0]], support, ca.tanh(push)


def idle(t, x, v, gain, seen):
    """Hold the support where it is, and push by a constant times what the model has, too."""
    (lag,) = symbols("driver.lag")
    return [(lag, 0.2)], [-lag], 0.0, -3.0 * v


def calm(t, x, v, gain, seen):
    """Push and support by time and two states, with a sign and a condition in front."""
    lag, memory = symbols("driver.lag", "driver.memory")
    push = -(gain * gain * memory * ca.cos(x))
    support = ca.if_else(t < 0.1, 0.0, 0.3 * ca.sin(t))
    return [(lag, 0.2), (memory, -0.4)], [memory - lag, v - memory], support, push


def values(kernel, equations):
    """Return all that a kernel computes at a point."""
    state, unknowns = starts(equations)
    at = TIME, state, unknowns
    found = [kernel.rates(*at), kernel.outputs(*at), *map(np.ravel, kernel.block(0, *at))]
    return np.concatenate([*found, kernel.event_values(*at), kernel.reset_values(*at)])


@pytest.mark.parametrize("driver", [hurried, calm, idle])
def test_cut_changes_no_value(folder, driver):
    equations = cart(driver)
    cut = compile_kernel(equations, backend="compiled")
    assert len(list(folder.glob("*.o"))) == 2  # the model, and the loop
    whole = compile_kernel(replace(equations, seam=None), backend="compiled")
    assert np.allclose(values(cut, equations), values(whole, equations), rtol=1e-14, atol=1e-15)
    other = equations.parameters[1].value * 2.0
    changed = cut.with_parameters([0.5, other, 1.5]), whole.with_parameters([0.5, other, 1.5])
    assert np.allclose(*(values(kernel, equations) for kernel in changed), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("driver", [hurried, calm])
def test_lanes_are_cut_alike(folder, driver, lanes=4):
    equations = cart(driver)
    kernel = compile_kernel(equations, backend="compiled")
    engine, _ = compile_lanes(equations, kernel.key, lanes)
    state, unknowns = starts(equations)
    x, z, p = (
        engine.spread(np.array([item] * lanes)) for item in (state, unknowns, kernel.parameters)
    )
    rates, _ = engine.rates(TIME, x, z, engine.prepare(p))
    alone = kernel.rates(TIME, state, np.array(z[:1, 0]))
    assert np.array_equal(rates[: alone.size, lanes - 1], alone)


@pytest.mark.parametrize("driver", [firm, calm, idle])
def test_another_driver_finds_the_model_compiled(folder, driver, monkeypatch):
    first, second = cart(hurried), cart(driver)
    assert fingerprint(first) != fingerprint(second)
    compile_kernel(first, backend="compiled")
    known = {path: path.stat().st_mtime_ns for path in folder.glob("*.o")}
    built = []
    monkeypatch.setattr(seam_library, "build_object", lambda *given: built.append(given))
    kernel = compile_kernel(second, backend="compiled")
    assert not kernel.report.cached
    assert not built
    assert known == {path: path.stat().st_mtime_ns for path in known}
    same_sizes = len(first.states) == len(second.states)
    assert (len(list(folder.glob("*.o"))) == len(known)) == same_sizes  # the loop is kept, too
    whole = compile_kernel(replace(second, seam=None), backend="compiled")
    assert np.allclose(values(kernel, second), values(whole, second), rtol=1e-14, atol=1e-15)


def test_another_model_is_another_model():
    keys = {seam_cut.cut_at_seam(cart(hurried)).model_key}
    plain = cart(hurried)
    opened = plain.seam.opened
    rate = ca.vertcat(opened.rate[0], 2.0 * opened.rate[1], opened.rate[2])
    changed = replace(plain, seam=replace(plain.seam, opened=replace(opened, rate=rate)))
    keys.add(seam_cut.cut_at_seam(changed).model_key)
    keys.add(seam_cut.cut_at_seam(cart(hurried, mass=2.0)).model_key)
    assert len(keys) == 2  # values of parameters are no part of what is compiled


def test_small_models_are_left_whole(monkeypatch):
    monkeypatch.setattr(seam_cut, "_LARGE", 4_000)
    assert seam_cut.cut_at_seam(cart(hurried)) is None
    assert seam_cut.cut_at_seam(replace(cart(hurried), seam=None)) is None
