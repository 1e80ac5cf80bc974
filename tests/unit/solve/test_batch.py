"""Many cases at once give what each gives alone."""

import numpy as np
import pytest
from solve_examples import Samples, oscillator, slider_crank, starts

from vehicledyn.base.errors import InputError
from vehicledyn.solve.batch import Cases, make_batch, run_batch
from vehicledyn.solve.kernel import compile_kernel
from vehicledyn.solve.methods.rk4 import RungeKutta4
from vehicledyn.solve.simulate import simulate

SPAN = {"start": 0.0, "stop": 0.5, "interval": 0.05}


def cases_of(equations, **changes):
    """Cases in which the named parameters take the given values, all of one length."""
    state, unknowns = starts(equations)
    names = [p.name for p in equations.parameters]
    n = len(next(iter(changes.values())))
    parameters = np.tile([p.value for p in equations.parameters], (n, 1))
    for name, values in changes.items():
        parameters[:, names.index(name)] = values
    return Cases(parameters, np.tile(state, (n, 1)), np.tile(unknowns, (n, 1)))


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
