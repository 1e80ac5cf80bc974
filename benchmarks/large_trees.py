"""Processor time to the first result of large chains and trees of bodies.

    python benchmarks/large_trees.py               # 250 to 1,000 bodies, a minute
    python benchmarks/large_trees.py 1000 --kernel compiled

Every body has its own mass and inertia; arms are equal. ``--parameters`` makes every number a
parameter, with oblique axes, as in chains.py. The first result is the sample after a first step
of the Runge-Kutta method; compilers count, and the cache of kernels is empty.
"""

from __future__ import annotations

import argparse
import os
import resource
import tempfile

import numpy as np
from chains import binary, build, serial

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive

STEP = 1e-4  # s
MOST = 10.0  # s of processor time for 1,000 bodies
GROWTH = 1.15  # time a body, 1,000 bodies to 250, at most
SHAPES = {"chain": serial, "tree": binary}


def plain(name, count, parent):
    """Return turning joints about axes of the frames, bodies with numbers of their own."""
    rng = np.random.default_rng(count)
    bodies = []
    for k in range(count):
        below = parent(k)
        body = Body(
            f"body{k}",
            GROUND if below < 0 else f"body{below}",
            (0.3 if k else 0.0, 0.0, 0.0),
            (Joint(f"R{1 + k % 3}", f"body{k}.angle", start=rng.uniform(-1.0, 1.0)),),
            mass=rng.uniform(1.0, 2.0),
            com=(0.1, 0.02, 0.03),
            inertia=(*rng.uniform(0.1, 0.13, 3), 0.0, 0.0, 0.0),
        )
        bodies.append(body)
    return System(name, ParameterTable(), tuple(bodies))


def seconds():
    """Return the processor time of this process and its finished children [s]."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(item.ru_utime + item.ru_stime for item in usages)


def measure(system, kernel_kind):
    """Return processor times up to the equations, the kernel and the first result [s]."""
    started = seconds()
    equations = derive(system)
    derived = seconds()
    kernel = compile_kernel(equations, backend=kernel_kind)
    compiled = seconds()
    found = []
    simulate(
        kernel,
        find("solver", "rk4")(step=STEP),
        start=0.0,
        stop=STEP,
        state=np.array([variable.start for variable in equations.states]),
        unknowns=np.zeros(0),
        interval=STEP,
        sink=lambda *parts: found.append(parts),
    )
    assert np.isfinite(found[-1][3]).all()
    return [derived - started, compiled - started, seconds() - started], kernel.description


def main(arguments=None):
    """Measure and print, with the growth where 250 and 1,000 bodies are measured."""
    parser = argparse.ArgumentParser(description="Measure first results of large trees.")
    parser.add_argument("counts", nargs="*", type=int, default=[250, 500, 1000])
    parser.add_argument("--kernel", default="auto", choices=("auto", "compiled", "interpreted"))
    parser.add_argument("--parameters", action="store_true")
    options = parser.parse_args(arguments)
    measure(plain("warm", 20, serial), "interpreted")  # loads what is loaded once
    for word, parent in SHAPES.items():
        found = {}
        for count in options.counts:
            system = (build if options.parameters else plain)(f"{word}", count, parent)
            with tempfile.TemporaryDirectory() as folder:
                os.environ["VEHICLEDYN_CACHE"] = folder
                times, kernel = measure(system, options.kernel)
            found[count] = times[-1]
            words = "derived {:.1f} s, prepared {:.1f} s, first result {:.1f} s".format(*times)
            print(f"{word} of {count:5}: {words}, {kernel}", flush=True)
        if {250, 1000} <= set(found):
            growth = found[1000] / found[250] * 250 / 1000
            print(f"{word}: {found[1000]:.1f} s (at most {MOST:g} s), time a body 1,000 to 250: "
                  f"{growth:.2f} (at most {GROWTH:.2f})")  # fmt: skip


if __name__ == "__main__":
    main()
