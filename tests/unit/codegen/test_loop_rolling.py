"""Long chains and trees in compiled code: loops over like joints, the same numbers."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.printers.kernel_source import kernel_source
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive

pytestmark = pytest.mark.long

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"


@pytest.fixture(scope="module")
def chains():
    sys.path.insert(0, str(BENCHMARKS))
    try:
        yield importlib.import_module("chains")
    finally:
        sys.path.remove(str(BENCHMARKS))
        sys.modules.pop("chains", None)


def sliders(count):
    """Bodies that slide and turn in turn, so that like joints do not follow one another."""
    rng, table, bodies = np.random.default_rng(count), ParameterTable(), []
    for k in range(count):
        at = tuple(
            table.add(f"at{k}.{i}", v, "m", "place") for i, v in enumerate(rng.normal(size=3))
        )
        mass = table.add(f"mass{k}", rng.uniform(1.0, 2.0), "kg", "mass")
        joint = Joint(f"{'TR'[k % 2]}{1 + k // 2 % 3}", f"q{k}", start=rng.uniform(-1.0, 1.0))
        parent = f"body{k - 1}" if k else GROUND
        six = {"mass": mass, "com": (0.1, -0.2, 0.3), "inertia": (2.0, 3.0, 4.0)}
        bodies.append(Body(f"body{k}", parent, at, (joint,), **six))
    return System("sliders", table, tuple(bodies))


def system(name, chains):
    return {
        "chain": lambda: chains.build("chain", 12, chains.serial),
        "tree": lambda: chains.build("tree", 15, chains.binary),
        "sliders": lambda: sliders(18),
    }[name]()


@pytest.mark.parametrize("name", ["chain", "tree", "sliders"])
def test_compiled_loops_equal_the_virtual_machine_and_the_written_form(
    name, chains, needs_compiler
):
    equations = derive(system(name, chains), formulation="articulated")
    compiled, interpreted = (
        compile_kernel(equations, backend=backend) for backend in ("compiled", "interpreted")
    )
    written = compile_kernel(
        derive(system(name, chains), formulation="composite"), backend="interpreted"
    )
    rng = np.random.default_rng(3)
    for _ in range(5):
        x = rng.uniform(-1.0, 1.0, len(equations.states))
        one, two, three = (k.rates(0.0, x, np.zeros(0)) for k in (compiled, interpreted, written))
        assert np.abs(one - two).max() <= 1e-12 * np.abs(two).max()
        assert np.abs(one - three).max() <= 1e-9 * np.abs(three).max()
        outputs = [k.outputs(0.0, x, np.zeros(0)) for k in (compiled, interpreted)]
        assert np.abs(outputs[0] - outputs[1]).max() <= 1e-12 * np.abs(outputs[1]).max()


def rates_of(source):
    """The code of the rates without the tables of places."""
    text = source[: source.index("static void outputs")]
    return re.sub(
        r"static const int \w+_at.*?};", "", text[text.index("rates_shared_0") :], flags=re.S
    )


def test_code_does_not_grow_with_a_chain(chains):
    texts = []
    for joints in (12, 24):
        equations = derive(chains.build("chain", joints, chains.serial), formulation="articulated")
        texts.append(rates_of(kernel_source(equations, derive_functions(equations))))
    short, long = (text.count(" = vd_f") for text in texts)
    assert short == long > 200


def test_a_chain_keeps_few_numbers_for_later(chains):
    """Sine and cosine, a wrench and a gate of seven numbers a joint, in places used again."""
    rooms, copied = [], []
    for joints in (16, 48):
        equations = derive(chains.build("chain", joints, chains.serial), formulation="articulated")
        text = rates_of(kernel_source(equations, derive_functions(equations)))
        rooms.append(int(re.findall(r"real s\[(\d+)\]", text)[-1]))
        copied.append(len(re.findall(r"r0\[\d+\] = s\[", text)))
    assert rooms[1] - rooms[0] <= 12 * 32
    # Accelerations go where they belong, not first into places of their own.
    assert max(copied) <= 2


def test_results_do_not_depend_on_lanes(chains, needs_compiler):
    kernel = compile_kernel(derive(system("tree", chains)), backend="compiled")
    rng = np.random.default_rng(1)
    cases = Cases(
        parameters=kernel.parameters * (1.0 + 0.01 * rng.random((5, 1))),
        states=rng.uniform(-1.0, 1.0, (5, len(kernel.equations.states))),
        unknowns=np.zeros((5, 0)),
    )
    span = {"start": 0.0, "stop": 0.02, "interval": 0.01, "channels": range(15)}
    one, four = (
        run_batch(make_batch(kernel, lanes=n), RungeKutta4(step=0.001), cases, **span).samples
        for n in (1, 4)
    )
    assert np.array_equal(one, four)
