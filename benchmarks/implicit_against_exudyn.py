"""Time steps on a stiff chain of four-bars side by side with EXUDYN's generalised-alpha method.

    python benchmarks/implicit_against_exudyn.py --exudyn PYTHON [--count 20] [--stiffness 1e4]

PYTHON is an interpreter that has EXUDYN; without it only vehicledyn is timed. Both take the same
method, spectral radius and steps; the exact motion is that of one pendulum on a spring, since all
uprights turn as one. Printed are the error of the angle at the end as a part of its amplitude, and
the wall time of the integration alone, the least of three runs.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time
from pathlib import Path

STOP, RATE, RADIUS = 1.0, 1.0, 0.8
GRAVITY = 9.81

EXUDYN = """
import json, math, sys, time
import exudyn as exu
from exudyn.itemInterface import *
count, stiffness, radius, stop, rate, step = json.loads(sys.argv[1])
system = exu.SystemContainer()
mbs = system.AddSystem()
ground = mbs.AddNode(NodePointGround(referenceCoordinates=[0, 0, 0]))
fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
base = mbs.AddObject(ObjectGround())
up = 0.5 * math.pi

def rod(at, angle, velocity, turn):
    node = mbs.AddNode(NodeRigidBody2D(
        referenceCoordinates=[*at, angle], initialVelocities=[*velocity, turn]))
    body = mbs.AddObject(ObjectRigidBody2D(
        physicsMass=1.0, physicsInertia=1.0 / 12.0, nodeNumber=node))
    mass = mbs.AddMarker(MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(LoadMassProportional(markerNumber=mass, loadVector=[0, -9.81, 0]))
    ends = [mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[x, 0, 0]))
            for x in (-0.5, 0.5)]
    return node, ends, mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=2))

def pin(a, b):
    mbs.AddObject(RevoluteJoint2D(markerNumbers=[a, b]))

def spring(a, b):
    mbs.AddObject(CoordinateSpringDamper(markerNumbers=[a, b], stiffness=stiffness))

nodes, before, turned = [], None, None
for k in range(count + 1):
    node, ends, angle = rod([k, 0.5], up, [0.5 * rate, 0], -rate)
    nodes.append(node)
    pin(mbs.AddMarker(MarkerBodyRigid(bodyNumber=base, localPosition=[k, 0, 0])), ends[0])
    spring(fixed, angle)
    if k:
        _, tips, own = rod([k - 0.5, 1.0], 0.0, [rate, 0], 0.0)
        pin(before, tips[0])
        pin(tips[1], ends[1])
        spring(turned, own)
    before, turned = ends[1], angle
mbs.Assemble()
s = exu.SimulationSettings()
s.timeIntegration.numberOfSteps = round(stop / step)
s.timeIntegration.endTime = stop
s.timeIntegration.generalizedAlpha.spectralRadius = radius
s.timeIntegration.newton.useModifiedNewton = True
s.solutionSettings.writeSolutionToFile = False
s.timeIntegration.verboseMode = 0
s.linearSolverType = exu.LinearSolverType.EigenSparse
began = time.perf_counter()
mbs.SolveDynamic(s)
seconds = time.perf_counter() - began
angle = mbs.GetNodeOutput(nodes[0], exu.OutputVariableType.Coordinates)[2]
print("RESULT", json.dumps([-float(angle), seconds]))
"""


def exact(count: int, stiffness: float) -> float:
    """Return the lean of the uprights at the end [rad]."""
    from scipy.integrate import solve_ivp

    inertia, weight = (count + 1) / 3.0 + count, GRAVITY * (0.5 * (count + 1) + count)
    spring = (2 * count + 1) * stiffness

    def rates(t: float, y: list[float]) -> list[float]:
        return [y[1], (weight * math.sin(y[0]) - spring * y[0]) / inertia]

    found = solve_ivp(rates, (0.0, STOP), [0.0, RATE], rtol=1e-12, atol=1e-14, method="DOP853")
    return float(found.y[0, -1])


def ours(count: int, stiffness: float) -> dict[str, object]:
    """Return the ways of vehicledyn: functions of the step that return lean and seconds."""
    import numpy as np

    sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "unit"))
    from chain_examples import chain  # type: ignore[import-not-found]

    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.registry import find
    from vehicledyn.integrate.simulate import simulate
    from vehicledyn.kernel.kernel import compile_kernel
    from vehicledyn.multibody import derive

    def way(method: str, solver: str, **settings: object) -> object:
        kernel = compile_kernel(derive(chain(count, method=method, stiffness=stiffness)))
        e = kernel.equations
        state = np.array([s.start for s in e.states])
        for k, variable in enumerate(e.states):
            if variable.name.endswith("_rate"):
                state[k] = RATE if variable.name.startswith("upright") else -RATE
        unknowns = np.array([u.start for u in e.unknowns])
        place = [s.name for s in e.states].index("upright_0.angle")

        def run(step: float) -> tuple[float, float]:
            last: list[float] = []
            began = time.perf_counter()
            simulate(
                kernel, find("solver", solver)(**settings, step=step), start=0.0, stop=STOP,
                state=state, unknowns=unknowns, interval=0.5, watched=False,
                sink=lambda t, x, z, y: last.append(float(x[-1, place])),
            )  # fmt: skip
            return last[-1] + 0.5 * math.pi, time.perf_counter() - began

        return run

    alpha = {"spectral_radius": RADIUS}
    return {
        "index 3": way("multipliers", "generalised_alpha", constraints="index3", **alpha),
        "reduced": way("partitioning", "generalised_alpha", **alpha),
        "rk4": way("partitioning", "rk4"),
    }


def theirs(python: str, numbers: list[float]) -> tuple[float, float]:
    """Run EXUDYN in its own interpreter."""
    call = [python, "-c", EXUDYN, json.dumps(numbers)]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    line = next(x for x in done.stdout.splitlines() if x.startswith("RESULT"))
    lean, seconds = json.loads(line.removeprefix("RESULT"))
    return lean, seconds


def main() -> None:
    """Print a table of steps, errors and times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--exudyn", help="interpreter that has EXUDYN")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--stiffness", type=float, default=1e4)
    given = parser.parse_args()
    truth = exact(given.count, given.stiffness)
    inertia = (given.count + 1) / 3.0 + given.count
    amplitude = RATE / math.sqrt((2 * given.count + 1) * given.stiffness / inertia)
    ways = ours(given.count, given.stiffness)
    print(f"{'way':10} {'step [ms]':>10} {'error':>10} {'time [ms]':>10}")
    for step in (2e-3, 1e-3, 5e-4):
        found = {name: [run(step) for _ in range(3)] for name, run in ways.items()}  # type: ignore[operator]
        if given.exudyn:
            numbers = [given.count, given.stiffness, RADIUS, STOP, RATE, step]
            found["EXUDYN"] = [theirs(given.exudyn, numbers) for _ in range(3)]
        for name, runs in found.items():
            error = abs(runs[-1][0] - truth) / amplitude
            least = min(seconds for _, seconds in runs)
            print(f"{name:10} {1e3 * step:10.3g} {error:10.2e} {1e3 * least:10.3g}")


if __name__ == "__main__":
    main()
