"""What peers.py measures of vehicledyn itself, and the exact motion of the four-bar chain."""

from __future__ import annotations

import platform
import re
import time
from pathlib import Path

import chains
import numpy as np
import speed
from scipy.integrate import solve_ivp

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.registry import find
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.simulate import simulate
from vehicledyn.multibody import Turn
from vehicledyn.symbolic import ops

SCENARIO = Path(__file__).resolve().parents[1] / "scenarios" / "systems" / "four_bar_chain.yaml"
LINKAGES = 20
STEPS = 200_000  # Runge-Kutta steps of one joint in a measurement
STAGES = 4  # right-hand sides of a step
SPREAD = 0.01  # of the numbers of cases, to either side


def describe(system, parent):
    """Return the numbers of a system of chains.py, as other engines need them."""
    entries = system.table.entries
    symbols, values = [ops.column([e.symbol for e in entries])], [e.value for e in entries]

    def numbers(expression):
        return ops.numeric(symbols, expression)(values)

    bodies = []
    for index, body in enumerate(system.bodies):
        turn, joint = body.joints
        if not isinstance(turn, Turn):
            raise TypeError("a body of chains.py is turned first")
        xx, yy, zz, xy, xz, yz = numbers(ops.column(list(body.inertia)))[:, 0]
        bodies.append(
            {
                "parent": parent(index),
                "at": numbers(ops.column(list(body.at)))[:, 0].tolist(),
                "rotation": numbers(turn.rotation).tolist(),
                "axis": int(joint.kind[1]) - 1,
                "mass": float(numbers(ops.column([body.mass]))[0, 0]),
                "com": numbers(ops.column(list(body.com)))[:, 0].tolist(),
                "inertia": [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
            }
        )
    return {"bodies": bodies, "gravity": list(system.gravity)}


def state_of(kernel, angles, rates):
    """Return the states of a chain with these angles and rates, in the order of the bodies."""
    places = {s.name: k for k, s in enumerate(kernel.equations.states)}
    state = np.zeros(len(places))
    for index, (angle, rate) in enumerate(zip(angles, rates, strict=True)):
        state[places[f"body{index}.angle"]] = angle
        state[places[f"body{index}.angle_rate"]] = rate
    return state


def accelerations(kernel, angles, rates):
    """Return the accelerations of a chain, in the order of the bodies."""
    places = {s.name: k for k, s in enumerate(kernel.equations.states)}
    found = kernel.rates(0.0, state_of(kernel, angles, rates), np.zeros(0))
    return found[[places[f"body{index}.angle_rate"] for index in range(len(angles))]]


def nanoseconds(kernel, angles, rates):
    """Return the processor time of a right-hand side inside the compiled loop [ns]."""
    duration = STEPS // len(angles) * chains.STEP
    started = time.process_time()
    statistics = simulate(
        kernel,
        find("solver", "rk4")(step=chains.STEP),
        start=0.0,
        stop=duration,
        state=state_of(kernel, angles, rates),
        unknowns=np.zeros(0),
        interval=duration,
        sink=lambda t, x, z, y: None,
    )
    return 1e9 * (time.process_time() - started) / statistics.evaluations


class Lanes:
    """Cases of a chain side by side in the lanes of the processor, each with its own numbers."""

    def __init__(self, kernel, angles, rates):
        self.lanes = suitable_lanes()
        self._batch = make_batch(kernel, lanes=self.lanes)
        count = 2 * self.lanes
        factors = 1.0 + SPREAD * np.linspace(-1.0, 1.0, count)
        self._cases = Cases(
            np.outer(factors, kernel.parameters),
            np.tile(state_of(kernel, angles, rates), (count, 1)),
            np.zeros((count, 0)),
        )
        self._steps = STEPS // (2 * len(angles))

    def nanoseconds(self):
        """Return the processor time of a right-hand side of one case [ns]."""
        duration = self._steps * chains.STEP
        started = time.process_time()
        found = run_batch(
            self._batch,
            find("solver", "rk4")(step=chains.STEP),
            self._cases,
            channels=[],
            start=0.0,
            stop=duration,
            interval=duration,
        )
        seconds = time.process_time() - started
        if any(end.failed for end in found.ends):
            raise SystemExit(f"a case failed: {found.ends}")
        return 1e9 * seconds / (STAGES * self._steps * len(found.ends))


class FourBarChain:
    """The chain of four-bar linkages of the scenario, prepared."""

    def __init__(self):
        loaded = load_scenario(SCENARIO)
        self._scenario = loaded.scenario
        self._prepared = prepare(loaded, backend="auto", progress=lambda *_: None)
        self._start = start_point(self._prepared, 0.0, self._scenario.start)
        self.step = self._scenario.solver.step

    def run(self):
        """Return processor and wall time of a simulation [s] and its error [m]."""
        s, prepared, samples = self._scenario, self._prepared, []
        started, wall = time.process_time(), time.perf_counter()
        simulate_monitored(
            prepared.subject.system,
            prepared.kernel,
            s.solver,
            start=0.0,
            stop=s.duration,
            state=self._start.state,
            unknowns=self._start.unknowns,
            interval=s.output.interval,
            sink=lambda *parts: samples.append(parts),
            progress=lambda *_: None,
            happened=lambda *_: None,
            watch=lambda: prepared.watch,
        )
        seconds, wall = time.process_time() - started, time.perf_counter() - wall
        names = [channel.name for channel in prepared.equations.channels]
        times, outputs = (np.concatenate([part[k] for part in samples]) for k in (0, 3))
        x, z = (outputs[:, names.index(name)] for name in ("b0.x", "b0.z"))
        return {"seconds": seconds, "wall": wall, "error": four_bar_error(times, x, z)}


def iltis(repeats):
    """Return (name, operations, [s a right-hand side]) of the Iltis, and [s] of 12 s of slalom."""
    cars = {
        "Magic Formula tyres, driver": speed.Car(speed.SLALOM, speed.SELDOM),
        "benchmark tyres": speed.Car(speed.RAMP, speed.SELDOM),
    }
    times, slalom = {words: [] for words in cars}, []
    whole = speed.Car(speed.SLALOM)
    for _ in range(repeats):
        for words, car in cars.items():
            times[words].append(_processor_seconds(car, 4.0) / car.evaluations)
        slalom.append(_processor_seconds(whole, speed.DURATION))
    return [(words, car.operations(), times[words]) for words, car in cars.items()], slalom


def _processor_seconds(car, duration):
    started = time.process_time()
    car.run(duration)
    return time.process_time() - started


def four_bar_error(times, x, y):
    """Return the largest distance of B0 from its exact place at the samples [m]."""
    inertia = (LINKAGES + 1) / 3 + LINKAGES
    moment = 9.81 * ((LINKAGES + 1) / 2 + LINKAGES)

    def rates(t, state):
        return [state[1], -moment / inertia * np.cos(state[0])]

    angle = solve_ivp(
        rates,
        (0.0, times[-1]),
        [0.5 * np.pi, -1.0],
        "DOP853",
        t_eval=times,
        rtol=1e-12,
        atol=1e-12,
    ).y[0]
    return float(np.hypot(x - np.cos(angle), y - np.sin(angle)).max())


def processor():
    """Return the name of the processor."""
    return _cpu_info(r"model name\s*:\s*(.+)") or platform.processor() or platform.machine()


def processor_frequency():
    """Return the frequency the system states now [Hz], zero if it states none."""
    return 1e6 * float(_cpu_info(r"cpu MHz\s*:\s*([\d.]+)") or 0.0)


def _cpu_info(pattern):
    path = Path("/proc/cpuinfo")
    found = re.search(pattern, path.read_text(encoding="utf-8")) if path.exists() else None
    return found.group(1).strip() if found else ""
