"""The source for CUDA: complete, equal to the compiled kernel, and good for NVIDIA's compiler.

Without a GPU it runs here as C++ for the processor, a thread after the other, with the words
that CUDA adds to the language defined away.
"""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest
from event_examples import bouncing_ball
from solve_examples import cases_of, double_pendulum, oscillator, slider_crank
from table_examples import height, quintic, rider

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.printers.cuda_source import cuda_source
from vehicledyn.integrate.batch import make_batch, run_batch
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.kernel.make_kernel import compile_kernel

pytestmark = pytest.mark.long

ON_THE_PROCESSOR = """
#include <cmath>
#include <cstring>
using namespace std;
#define __device__
#define __global__
#define __constant__
#define __forceinline__ inline
#define __noinline__ __attribute__((noinline))
#define __ldg(place) (*(place))
static long long __double_as_longlong(double a) {
  long long bits;
  memcpy(&bits, &a, sizeof bits);
  return bits;
}
static struct { unsigned x; } blockIdx, blockDim = {1}, threadIdx;
"""
ONE_AFTER_THE_OTHER = """
extern "C" void set_thread(unsigned thread) { blockIdx.x = thread; }
"""
STEP, INTERVAL, STOP = 0.005, 0.05, 0.5


@pytest.fixture
def compiler():
    found = shutil.which("g++") or shutil.which("clang++")
    if found is None:
        pytest.skip("needs a C++ compiler")
    return found


def run_on_the_processor(compiler, folder, equations, cases):
    """Return the samples (n, n_samples, n_channels) and statuses of the CUDA source."""
    file = folder / "model.cpp"
    file.write_text(ON_THE_PROCESSOR + cuda_source(equations) + ONE_AFTER_THE_OTHER)
    library = folder / "model.so"
    options = ["-O1", "-march=native", "-ffp-contract=off", "-shared", "-fPIC", "-w"]
    subprocess.run([compiler, *options, str(file), "-o", str(library)], check=True, timeout=120)
    model = ctypes.CDLL(str(library))
    n, channels = len(cases), np.arange(len(equations.channels), dtype=np.intc)
    n_samples = round(STOP / INTERVAL) + 1
    p, x, z = (
        np.ascontiguousarray(item.T) for item in (cases.parameters, cases.states, cases.unknowns)
    )
    rows = TableRows(equations.tables)
    p = np.vstack([p, np.tile(rows.numbers[:, None], (1, n))])
    assert len(p) == ctypes.c_int.in_dll(model, "n_given").value
    constants = ctypes.c_int.in_dll(model, "n_constants").value
    c, samples = np.zeros((constants, n)), np.full((n_samples, channels.size, n), np.nan)
    status, where = np.zeros(n, dtype=np.intc), np.zeros(n, dtype=np.intc)
    good = np.zeros(n, dtype=np.longlong)
    count, steps = ctypes.c_longlong(n), ctypes.c_longlong(round(STOP / STEP))
    per = ctypes.c_longlong(round(INTERVAL / STEP))

    def at(array):
        return ctypes.c_void_p(array.ctypes.data)

    for thread in range(n + 1):  # one more than there are cases
        model.set_thread(thread)
        model.vd_prepare_cases(count, at(p), at(c))
        start, interval = ctypes.c_double(0.0), ctypes.c_double(INTERVAL)
        model.vd_run_cases(
            count, 0, steps, per, start, interval, at(c), at(x), at(z),
            int(channels.size), at(channels), at(samples), at(status), at(where), at(good),
        )  # fmt: skip
    return samples.transpose(2, 0, 1), status, good


@pytest.mark.parametrize(
    ("make", "changes"),
    [
        (oscillator, {"stiffness": [2.0, 5.0, 9.0]}),
        (double_pendulum, {"g": [9.81, 3.7, 1.6]}),
        (slider_crank, {"inertia": [0.2, 0.25]}),
        (lambda: rider(height(), quintic()), {"k": [0.4, 0.7]}),
    ],
)
def test_equals_the_compiled_kernel(needs_compiler, compiler, tmp_path, make, changes):
    equations = make()
    cases = cases_of(equations, **changes)
    found, status, good = run_on_the_processor(compiler, tmp_path, equations, cases)
    batch = make_batch(compile_kernel(equations, backend="compiled"))
    expected = run_batch(
        batch,
        RungeKutta4(step=STEP),
        cases,
        start=0.0,
        stop=STOP,
        interval=INTERVAL,
        channels=range(len(equations.channels)),
    )
    assert not any(end.failed for end in expected.ends)
    assert (status == 0).all()
    assert (good == round(STOP / STEP)).all()
    np.testing.assert_allclose(found, expected.samples, rtol=1e-11, atol=1e-12)


def test_models_with_events_are_refused():
    with pytest.raises(InputError, match="has events, which runs on a GPU do not watch"):
        cuda_source(bouncing_ball())


def test_nvidias_compiler_takes_it(tmp_path):
    compiler = shutil.which("nvcc")
    if compiler is None:
        pytest.skip("needs nvcc")
    file = tmp_path / "model.cu"
    file.write_text(cuda_source(slider_crank()))
    options = ["--fmad=false", "-arch=native", "-cubin", "-o", str(tmp_path / "model.cubin")]
    subprocess.run([compiler, *options, str(file)], check=True, timeout=300)
