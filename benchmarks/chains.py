"""Measure forward dynamics of long trees: ``python benchmarks/chains.py [--quick] [--json FILE]``.

Serial chains and a binary tree of turning joints, every frame oblique (three angles and three
lengths), every inertia full, every number a parameter at run time. Prints the operations of a
right-hand side, the processor time of deriving, generating and compiling its kernel, and the
time of one call. Writes nothing but the JSON file where one is asked for.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from vehicledyn.base.registry import find
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.printers.kernel_source import kernel_source
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, Turn, derive
from vehicledyn.symbolic import rotations

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
STEP = 1e-5  # s, so short that nothing moves far
STEPS = 20_000  # Runge-Kutta steps of one joint in a measurement
LENGTHS = (6, 12, 30, 100)
GROWTH = 1.15  # cost a joint at 100 joints over that at 12, at most
SECONDS = 8.0  # generation and compilation of 100 joints, at most


@dataclass(frozen=True)
class Measured:
    """What one system costs; times of derivation, generation and compilation are of the CPU."""

    name: str
    joints: int
    formulation: str
    operations: int
    prepared: int
    derivation_seconds: float
    generation_seconds: float
    compilation_seconds: float
    nanoseconds: float

    def line(self) -> str:
        return (
            f"{self.name:17} {self.formulation:10}{self.operations:7} {self.prepared:8} "
            f"{self.derivation_seconds:9.2f} {self.generation_seconds:9.2f} "
            f"{self.compilation_seconds:9.2f} {self.nanoseconds:7.0f} ns, "
            f"{self.nanoseconds / self.joints:.1f} a joint"
        )


def serial(index):
    return index - 1


def binary(index):
    return (index - 1) // 2


def build(name, joints, parent):
    """Return a tree of turning joints with random numbers, all of them parameters."""
    rng = np.random.default_rng(joints)
    table = ParameterTable()

    def numbers(words, values):
        return tuple(table.add(f"{words}.{k}", v, "1", words) for k, v in enumerate(values))

    bodies = []
    for index in range(joints):
        word = f"body{index}"
        yaw, pitch, roll = numbers(f"{word}.angles", rng.uniform(-1.0, 1.0, 3))
        turn = rotations.turn(3, yaw) @ rotations.turn(2, pitch) @ rotations.turn(1, roll)
        points = rng.normal(size=(6, 3)) * 0.1
        moments = 0.4 * sum(np.eye(3) * (p @ p) - np.outer(p, p) for p in points)
        below = parent(index)
        body = Body(
            word,
            GROUND if below < 0 else f"body{below}",
            numbers(f"{word}.at", rng.uniform(-0.3, 0.3, 3)),
            (Turn(turn), Joint(f"R{1 + index % 3}", f"{word}.angle", start=rng.uniform(-1, 1))),
            mass=table.add(f"{word}.mass", rng.uniform(0.5, 2.0), "kg", "mass"),
            com=numbers(f"{word}.com", rng.uniform(-0.1, 0.1, 3)),
            inertia=numbers(f"{word}.inertia", [moments[pair] for pair in PAIRS]),
        )
        bodies.append(body)
    return System(name, table, tuple(bodies))


def measure(name, joints, parent, *, formulation="auto", repeats=3):
    """Return what a system costs."""
    clock = _processor_seconds()
    equations = derive(build(name, joints, parent), formulation=formulation)
    derived = _processor_seconds() - clock
    clock = _processor_seconds()
    functions = derive_functions(equations)
    kernel_source(equations, functions)
    generated = _processor_seconds() - clock
    clock = _processor_seconds()
    kernel = compile_kernel(equations, backend="compiled")
    compiled = max(0.0, _processor_seconds() - clock - generated)
    counts = kernel.report.operations
    return Measured(
        name=name,
        joints=joints,
        formulation=formulation,
        operations=counts["rates"],
        prepared=counts["prepare"],
        derivation_seconds=derived,
        generation_seconds=generated,
        compilation_seconds=compiled,
        nanoseconds=_right_hand_side(kernel, joints, repeats),
    )


def _processor_seconds():
    """Return the processor time of this process and its finished children [s]."""
    own, children = (resource.getrusage(who) for who in _WHO)
    return sum(item.ru_utime + item.ru_stime for item in (own, children))


_WHO = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def _right_hand_side(kernel, joints, repeats):
    """Return the least processor time of a right-hand side within the compiled loop [ns]."""
    state = np.array([variable.start for variable in kernel.equations.states])
    solver = find("solver", "rk4")(step=STEP)
    duration = STEPS // joints * STEP
    times = []
    for _ in range(repeats + 1):
        started = time.process_time()
        statistics = simulate(
            kernel,
            solver,
            start=0.0,
            stop=duration,
            state=state,
            unknowns=np.zeros(0),
            interval=duration,
            sink=lambda t, x, z, y: None,
        )
        times.append(1e9 * (time.process_time() - started) / statistics.evaluations)
    return min(times[1:])


def main(arguments=None):
    """Measure, print and, if asked, write the figures as JSON."""
    parser = argparse.ArgumentParser(description="Measure forward dynamics of long trees.")
    parser.add_argument("--quick", action="store_true", help="up to 30 joints, few repetitions")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args(arguments)
    lengths = [n for n in LENGTHS if n <= 30] if options.quick else LENGTHS
    repeats = 3 if options.quick else 30
    known = os.environ.get("VEHICLEDYN_CACHE")
    print(f"{'':26} {'rates':>8} {'prepare':>8} {'derive':>9} {'gener.':>9} {'compile':>9}")
    print(f"{'':26} {'operat.':>8} {'operat.':>8} {'CPU s':>9} {'CPU s':>9} {'CPU s':>9}")
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ["VEHICLEDYN_CACHE"] = folder
        cases = [(f"chain of {n}", n, serial, "auto") for n in lengths]
        cases += [(f"chain of {n}", n, serial, "composite") for n in lengths if n <= 30]
        cases.append(("binary tree of 30", 30, binary, "auto"))
        for name, joints, parent, formulation in cases:
            found = measure(name, joints, parent, formulation=formulation, repeats=repeats)
            figures.append(found)
            print(found.line(), flush=True)
    if known is None:
        del os.environ["VEHICLEDYN_CACHE"]
    else:
        os.environ["VEHICLEDYN_CACHE"] = known
    _judge({f.joints: f for f in figures if f.name.startswith("chain") and f.formulation == "auto"})
    if options.json:
        content = [asdict(figure) for figure in figures]
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _judge(chains):
    """Print growth and build time beside what the project asks for."""
    if not {12, 100} <= set(chains):
        return
    short, long = chains[12], chains[100]
    for words in ("operations", "nanoseconds"):
        growth = getattr(long, words) / getattr(short, words) * 12 / 100
        print(f"{words} a joint, 100 joints to 12: {growth:.2f} (at most {GROWTH:.2f})")
    seconds = long.generation_seconds + long.compilation_seconds
    print(f"generation and compilation of 100 joints: {seconds:.1f} s (at most {SECONDS:g} s)")


if __name__ == "__main__":
    main()
