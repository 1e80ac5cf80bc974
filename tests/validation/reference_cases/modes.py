"""Eigenvalues about straight running against the flow of the integrated nonlinear motion.

The linearisation differentiates the equations exactly. The check knows nothing of that: it
integrates the compiled kernel for a short time from states displaced to either side, which
gives the matrix Φ = ∂x(T)/∂x(0) whose eigenvalues are exp(λ T).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.optimize import linear_sum_assignment

from reference_cases.comparison import Comparison, Group, deviation, exactly
from reference_cases.motions import quiet, standard_model
from vehicledyn.analyses import find_modes
from vehicledyn.analyses.preparation.prepare import equilibrium_point
from vehicledyn.files.scenario import load_model
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.simulate import simulate

SPEEDS = (5.0, 10.0, 20.0, 30.0)
SPAN = 0.01  # s, short enough for the fastest mode to turn by less than half a turn
STEP = 0.0005  # s
DISPLACEMENT = 1e-5  # of each state in its unit; its square is far below the band
SMALL = 1e-4
"""Below this an eigenvalue is a zero [1/s]: a free motion is moved by the slow loss of speed."""


@lru_cache(maxsize=1)
def modes(speeds=SPEEDS):
    """Return the modes of the linearisation at each speed."""
    target = load_model("iltis")
    return find_modes(target, speeds=list(speeds), backend="auto", progress=quiet).speeds


def flow_eigenvalues(speed):
    """Return the eigenvalues that the integrated motion has, all of them [1/s]."""
    prepared = standard_model()
    point = equilibrium_point(prepared, speed, "steady")
    size = len(point.state)
    columns = []
    for k in range(size):
        ends = [
            _end(prepared.kernel, point.state + sign * DISPLACEMENT * np.eye(size)[k], point)
            for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]) / (2.0 * DISPLACEMENT))
    return np.log(np.linalg.eigvals(np.stack(columns, axis=1)).astype(complex)) / SPAN


def _end(kernel, state, point):
    samples = []
    simulate(
        kernel,
        RungeKutta4(step=STEP),
        start=0.0,
        stop=SPAN,
        state=state,
        unknowns=point.unknowns,
        interval=SPAN,
        sink=lambda t, x, z, y: samples.append(x.copy()),
    )
    return np.vstack(samples)[-1]


def matched(entry):
    """Return pairs of eigenvalues of linearisation and flow but for zeros, and the flow's count."""
    own = np.array([m.eigenvalue for m in entry.modes if abs(m.eigenvalue) > SMALL])
    flow = flow_eigenvalues(entry.speed)
    flow = flow[(flow.imag > -SMALL) & (np.abs(flow) > SMALL * 10.0)]
    distance = np.abs(own[:, None] - flow[None, :])
    rows, columns = linear_sum_assignment(distance)
    return list(zip(own[rows], flow[columns], strict=True)), len(flow)


def compare():
    """Return the comparisons at four speeds."""
    rows = []
    for entry in modes():
        pairs, count = matched(entry)
        zeros = [m for m in entry.modes if abs(m.eigenvalue) <= SMALL]
        others = [m.eigenvalue.real for m in entry.modes if abs(m.eigenvalue) > SMALL]
        at = f"{entry.speed:g} m/s"
        rows += [
            exactly("straight running", f"{at}: zeros (x, y, heading, speed)", 4, len(zeros)),
            Comparison(
                "straight running",
                f"{at}: largest real part of the other modes",
                "stable",
                f"{max(others):.4f} 1/s",
                "< 0",
                max(others) < 0.0,
            ),
            exactly("flow of the nonlinear motion", f"{at}: modes but zeros", count, len(others)),
            deviation(
                "flow of the nonlinear motion",
                f"{at}: eigenvalues",
                reference=f"{len(pairs)} modes, up to {max(abs(f) for _, f in pairs):.4g} 1/s",
                largest=max(abs(own - flow) / abs(flow) for own, flow in pairs),
                band=1e-4,
                unit="(relative)",
            ),
        ]
    note = (
        "Calspan tyres, wheel spin prescribed. Band: the step of the integration and the "
        "displacement leave 1e-5; 5e-3 is asked of the program."
    )
    return Group("Iltis: eigenvalues about straight running", note, tuple(rows))
