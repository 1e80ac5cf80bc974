"""Many cases at once give what each gives alone."""

import numpy as np
import pytest
from event_examples import bouncing_ball
from solve_examples import Samples, cases_of, double_pendulum, oscillator, slider_crank

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.rkc import RungeKuttaChebyshev
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.integrate.simulate import simulate
from vehicledyn.integrate.single_case import SingleCase
from vehicledyn.kernel.make_kernel import compile_kernel

SPAN = {"start": 0.0, "stop": 0.5, "interval": 0.05}


def alone(kernel, cases, index):
    """Return times and outputs of one case, run by itself."""
    samples = Samples()
    simulate(
        kernel.with_parameters(cases.parameters[index]),
        RungeKutta4(step=0.005),
        state=cases.states[index],
        unknowns=cases.unknowns[index],
        sink=samples,
        **SPAN,
    )
    return samples


def test_each_case_is_what_it_is_alone(backend):
    equations = slider_crank()
    kernel = compile_kernel(equations, backend=backend)
    cases = cases_of(equations, mass=np.linspace(0.5, 2.0, 5), inertia=np.linspace(1.0, 0.2, 5))
    result = run_batch(make_batch(kernel), RungeKutta4(step=0.005), cases, channels=[2, 0], **SPAN)
    for index in range(len(cases)):
        single = alone(kernel, cases, index)
        assert np.array_equal(result.times, single.times)
        assert np.array_equal(result.samples[index], single.outputs[:, [2, 0]])
        assert not result.ends[index].failed
        assert result.ends[index].samples == len(result.times)


def test_parts_are_told_in_order_and_single_precision_on_request(backend):
    equations = oscillator()
    kernel = compile_kernel(equations, backend=backend)
    told = []
    result = run_batch(
        make_batch(kernel),
        RungeKutta4(step=0.005),
        cases_of(equations, stiffness=[1.0, 2.0, 3.0]),
        channels=[0],
        single=True,
        finished=lambda which, samples, ends: told.extend(zip(which, samples, ends, strict=True)),
        **SPAN,
    )
    assert result.samples.dtype == np.float32
    assert [index for index, _, _ in told] == [0, 1, 2]
    assert all(np.array_equal(s, result.samples[k]) for k, s, _ in told)
    assert tuple(end for _, _, end in told) == result.ends


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"states": np.zeros((2, 1))}, "must have the shape"),
        ({"parameters": np.full((2, 3), np.nan)}, "case 0 hold a value that is not finite"),
    ],
)
def test_sizes_and_values_are_checked(change, words):
    equations = oscillator()
    good = cases_of(equations, stiffness=[1.0, 2.0])
    batch = make_batch(compile_kernel(equations, backend="interpreted"))
    cases = Cases(**{**vars(good), **change})
    with pytest.raises(InputError, match=words):
        run_batch(batch, RungeKutta4(step=0.005), cases, channels=[0], **SPAN)


def same(one, two):
    return np.array_equal(one, two, equal_nan=True)


METHODS = [
    RungeKutta4(step=0.005),
    SymplecticEuler(step=0.005),
    RungeKuttaChebyshev(step=0.005, stages=4),
]


@pytest.mark.parametrize("solver", METHODS, ids=["rk4", "symplectic_euler", "rkc"])
@pytest.mark.parametrize("example", [slider_crank, double_pendulum, oscillator])
def test_lanes_change_nothing(lanes, example, solver):
    equations = example()
    kernel = compile_kernel(equations, backend="compiled")
    name = equations.parameters[-1].name
    value = equations.parameters[-1].value
    cases = cases_of(equations, **{name: value * np.linspace(0.8, 1.2, lanes + 3)})
    channels = range(len(equations.channels))
    abreast, alone = (
        run_batch(batch, solver, cases, channels=channels, **SPAN)
        for batch in (make_batch(kernel, lanes=lanes), make_batch(kernel, lanes=1))
    )
    assert same(abreast.samples, alone.samples)
    assert abreast.ends == alone.ends
    turned = Cases(*[np.ascontiguousarray(item[::-1]) for item in vars(cases).values()])
    back = run_batch(make_batch(kernel, lanes=lanes), solver, turned, channels=channels, **SPAN)
    assert same(back.samples[::-1], alone.samples)


def test_a_case_that_fails_stops_alone(lanes):
    equations = slider_crank()
    kernel = compile_kernel(equations, backend="compiled")
    cases = cases_of(equations, rod_length=[2.0, 0.9, 1.9, 0.8, 2.2, 2.0])
    cases.states[2, 1] = 1e150  # its angle grows beyond all numbers
    cases.states[[1, 3], 1] = 6.0  # these rods are too short to let the crank turn
    solver = RungeKutta4(step=0.005)
    abreast, alone = (
        run_batch(make_batch(kernel, lanes=n), solver, cases, channels=[0, 1], **SPAN)
        for n in (lanes, 1)
    )
    assert [end.failed for end in alone.ends] == [False, True, True, True, False, False]
    assert abreast.ends == alone.ends
    assert same(abreast.samples, alone.samples)
    for end, samples in zip(abreast.ends, abreast.samples, strict=True):
        assert np.isfinite(samples[: end.samples]).all()
        assert np.isnan(samples[end.samples :]).all()
    assert "block 'crank loop' at t = " in abreast.ends[1].message


def test_a_start_that_cannot_be_closed_is_told(lanes):
    equations = slider_crank()
    kernel = compile_kernel(equations, backend="compiled")
    cases = cases_of(equations, rod_length=[2.0, 0.1])
    for n in (lanes, 1):
        result = run_batch(make_batch(kernel, lanes=n), METHODS[0], cases, channels=[0], **SPAN)
        assert [end.samples for end in result.ends] == [len(result.times), 0]
        assert "t = 0 s" in result.ends[1].message
        assert np.isnan(result.samples[1]).all()


def test_parts_in_lanes(lanes):
    equations = oscillator()
    kernel = compile_kernel(equations, backend="compiled")
    cases = cases_of(equations, stiffness=np.linspace(1.0, 3.0, lanes + 2))
    told, parts = [], []
    result = run_batch(
        make_batch(kernel, lanes=lanes),
        METHODS[0],
        cases,
        channels=[0],
        single=True,
        finished=lambda which, samples, ends: told.append((which, samples.copy(), ends)),
        progress=lambda what, part: parts.append(part),
        **SPAN,
    )
    assert [list(which) for which, _, _ in told] == [list(range(lanes)), [lanes, lanes + 1]]
    assert same(np.concatenate([samples for _, samples, _ in told]), result.samples)
    assert result.samples.dtype == np.float32
    assert parts == sorted(parts)
    assert parts[-1] == 1.0


def test_interrupt_keeps_what_is_finished(lanes):
    equations = oscillator()
    kernel = compile_kernel(equations, backend="compiled")
    done = []

    def finished(which, samples, ends):
        done.extend(which)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_batch(
            make_batch(kernel, lanes=lanes),
            METHODS[0],
            cases_of(equations, stiffness=np.linspace(1.0, 3.0, 3 * lanes)),
            channels=[0],
            finished=finished,
            **SPAN,
        )
    assert done == list(range(lanes))


def test_only_cases_with_events_leave_their_lanes(lanes, monkeypatch):
    """Balls from above 1.23 m do not reach the ground in half a second; one starts on it."""
    equations = bouncing_ball()
    kernel = compile_kernel(equations, backend="compiled")
    cases = cases_of(equations, restitution=np.linspace(0.5, 0.9, 11))
    heights = np.linspace(0.5, 2.5, 11)
    heights[4] = 0.0
    cases.states[:, 0], cases.states[4, 1] = heights, 3.0
    left, run = [], SingleCase.run

    def told(alone, cases, number, room):
        left.append(float(cases.states[number, 0]))
        return run(alone, cases, number, room)

    one = run_batch(make_batch(kernel, lanes=1), METHODS[0], cases, channels=[0], **SPAN)
    monkeypatch.setattr(SingleCase, "run", told)
    many = run_batch(make_batch(kernel, lanes=lanes), METHODS[0], cases, channels=[0], **SPAN)
    assert left == [height for height in heights if height < 1.23]
    assert same(many.samples, one.samples)
    assert many.ends == one.ends
    for index, height in enumerate(heights):
        energy = many.samples[index, :, 0]
        assert (energy[-1] < energy[0] - 1e-3) == (0.0 < height < 1.23)


def test_without_lanes_in_one_line(needs_compiler, monkeypatch, caplog):
    monkeypatch.setattr("vehicledyn.integrate.batch.suitable_lanes", lambda: 8)
    kernel = compile_kernel(oscillator())
    monkeypatch.setenv("VEHICLEDYN_CC", "none")
    batch = make_batch(kernel, lanes=4)
    assert batch.lanes == 1
    assert "VEHICLEDYN_CC=none; cases run one after the other" in batch.remark
    assert [record.getMessage() for record in caplog.records] == [batch.remark]
    interpreted = compile_kernel(oscillator(), backend="interpreted")
    assert "is interpreted" in make_batch(interpreted, lanes=4).remark


@pytest.mark.parametrize(("flags", "most"), [("sse2 avx", 1), ("avx2 fma", 4), ("", 1)])
def test_processors_without_wide_registers_get_fewer_lanes(monkeypatch, flags, most):
    text = f"processor : 0\nflags : fpu {flags}\n"
    monkeypatch.setattr("pathlib.Path.read_text", lambda *arguments, **more: text)
    assert suitable_lanes() == most


def test_lanes_that_cannot_be():
    kernel = compile_kernel(oscillator(), backend="interpreted")
    with pytest.raises(InputError, match="lanes=3: choose 1, 4 or 8"):
        make_batch(kernel, lanes=3)
