"""Cost of derivatives in simulations: ``python benchmarks/tangents.py [--seconds 4] [--rounds 5]``.

The slalom of the Iltis: a plain run, the same with tangents by 1, 8 and 20 parameters, and one
figure by all parameters with adjoints of a sine steer, and its Hessian times a direction of these.
Candidates take turns; printed are medians
of processor times, with the smallest and the largest, and their ratio to a run.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import vehicledyn.catalogue  # noqa: F401 - registers models, tyres, solvers
from vehicledyn.analyse.gradients.adjoint import figure_adjoint
from vehicledyn.analyse.gradients.curvature import CurvatureCode
from vehicledyn.analyse.gradients.key_figures import figure_slope
from vehicledyn.analyse.gradients.sampled_run import sampled_run
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.interface.targets import read_scenario
from vehicledyn.kernel.make_kernel import compile_kernel

COUNTS = (1, 8, 20)


def prepared(name: str, channel: str, seconds: float, *, back: bool = False) -> MotionStudy:
    """Return a scenario with its compiled tangents."""
    loaded = read_scenario(name, [f"duration={seconds} s"])
    return MotionStudy.of(loaded, [channel], lambda *_: None, back=back)


def plain(study: MotionStudy) -> Callable[[], object]:
    """Return a run without derivatives, compiled whether or not that pays for one."""
    start = (study.start.state, study.start.unknowns)
    kernel = compile_kernel(study.prepared.equations)
    kernel.set_parameters(study.prepared.kernel.parameters)
    return lambda: sampled_run(kernel, study.grid, study.n_intervals, start)


def forward(study: MotionStudy, count: int) -> Callable[[], object]:
    """Return a run with tangents by the first parameters of the car."""
    e, kernel = study.prepared.equations, study.prepared.kernel
    names = [p.name for p in e.parameters if p.name.startswith(("front", "leaf", "shock"))]
    chosen = directions(e, kernel.parameters, study.start.state, names[:count])
    return lambda: study.followed(chosen, lambda *_: None)


def reverse(study: MotionStudy) -> Callable[[], object]:
    """Return the adjoints of one figure by all parameters."""

    def figure(times: np.ndarray, values: np.ndarray) -> tuple[object, np.ndarray]:
        found = figure_slope("rms", times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    return lambda: figure_adjoint(
        study.code,
        study.prepared.kernel.parameters,
        study.grid,
        n_intervals=study.n_intervals,
        start=(study.start.state, study.start.unknowns),
        figure=figure,
    )


def second(study: MotionStudy) -> Callable[[], object]:
    """Return the Hessian of one figure by all parameters, times a direction."""
    e, kernel = study.prepared.equations, study.prepared.kernel
    code = CurvatureCode(e, study.channels)
    direction = 0.01 * kernel.parameters
    state = study.start.state
    return lambda: code.along(
        (kernel.parameters, direction),
        study.grid,
        n_intervals=study.n_intervals,
        start=(state, study.start.unknowns, 0.0 * state),
        figure=("rms", 0),
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    slalom = prepared("iltis_slalom", "chassis.yaw", options.seconds)
    steer = prepared("iltis_sine_steer", "chassis.yaw", options.seconds, back=True)
    candidates = {"slalom, plain": plain(slalom)}
    candidates |= {f"slalom, {n} tangents": forward(slalom, n) for n in COUNTS}
    candidates |= {"sine steer, plain": plain(steer), "sine steer, adjoints": reverse(steer)}
    candidates["sine steer, Hessian times a vector"] = second(steer)
    times: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(options.rounds):
        for name, run in candidates.items():
            begun = time.process_time()
            run()
            times[name].append(time.process_time() - begun)
    for name, found in times.items():
        base = statistics.median(times[name.partition(",")[0] + ", plain"])
        middle = statistics.median(found)
        print(
            f"{name:36} {middle:8.3f} s ({min(found):.3f} to {max(found):.3f})"
            f"  {middle / base:6.2f} runs"
        )


if __name__ == "__main__":
    main()
