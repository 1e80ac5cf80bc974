"""Time steps on stiff models side by side with EXUDYN's generalised-alpha method.

    python benchmarks/implicit_against_exudyn.py --exudyn PYTHON [--count 20] [--stiffness 1e4]

PYTHON is an interpreter that has EXUDYN; without it only vehicledyn is timed. Both take the same
method, spectral radius and steps on the same two models:

a chain of four-bars with springs at all joints, whose exact motion is that of one pendulum on a
spring, since all uprights turn as one; and a clamped beam of rigid segments with springs between
them, straight at first, that swings under its weight, against ``cvodes`` with fine tolerances.

Printed are the error of an angle at the end as a part of its amplitude, and the processor
time of the integration alone, the least of three runs.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

STOP, RATE, RADIUS = 1.0, 1.0, 0.8
GRAVITY = 9.81
SEGMENTS = 32
"""Segments of the beam: steel, 1 m long, 20 mm wide and 2 mm thick."""
MASS, BENDING = 7850.0 * 20e-3 * 2e-3 / SEGMENTS, 2.1e11 * 20e-3 * 2e-3**3 / 12.0 * SEGMENTS
"""Mass of a segment [kg] and stiffness of the springs between them [N m/rad]."""
LAG = 1e-3
"""Damping of these springs by their stiffness [s]: it ends what only a far finer step resolves."""
STEPS = {"four-bars": (2e-3, 1e-3, 5e-4), "beam": (2e-3, 1e-3, 5e-4)}

Run = Callable[[float], tuple[float, float]]
"""Takes a step [s]; returns an angle at the end [rad] and processor time [s]."""

EXUDYN = """
import json, math, sys, time
import exudyn as exu
from exudyn.itemInterface import *
kind, count, stiffness, damping, mass, radius, stop, rate, step = json.loads(sys.argv[1])
system = exu.SystemContainer()
mbs = system.AddSystem()
ground = mbs.AddNode(NodePointGround(referenceCoordinates=[0, 0, 0]))
fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
base = mbs.AddObject(ObjectGround())
up = 0.5 * math.pi

def rod(at, angle, velocity, turn, mass=1.0, length=1.0):
    node = mbs.AddNode(NodeRigidBody2D(
        referenceCoordinates=[*at, angle], initialVelocities=[*velocity, turn]))
    body = mbs.AddObject(ObjectRigidBody2D(
        physicsMass=mass, physicsInertia=mass * length**2 / 12.0, nodeNumber=node))
    whole = mbs.AddMarker(MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(LoadMassProportional(markerNumber=whole, loadVector=[0, -9.81, 0]))
    ends = [mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[x, 0, 0]))
            for x in (-0.5 * length, 0.5 * length)]
    return node, ends, mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=2))

def pin(a, b):
    mbs.AddObject(RevoluteJoint2D(markerNumbers=[a, b]))

def spring(a, b):
    mbs.AddObject(CoordinateSpringDamper(
        markerNumbers=[a, b], stiffness=stiffness, damping=damping))

def beam():
    before, turned = None, fixed
    length = 1.0 / count
    before = mbs.AddMarker(MarkerBodyRigid(bodyNumber=base, localPosition=[0, 0, 0]))
    for k in range(count):
        node, ends, angle = rod([(k + 0.5) * length, 0.0], 0.0, [0, 0], 0.0, mass, length)
        pin(before, ends[0])
        spring(turned, angle)
        before, turned = ends[1], angle
    return node

def four_bars():
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
    return nodes[0]

seen = beam() if kind == "beam" else four_bars()
mbs.Assemble()
s = exu.SimulationSettings()
s.timeIntegration.numberOfSteps = round(stop / step)
s.timeIntegration.endTime = stop
s.timeIntegration.generalizedAlpha.spectralRadius = radius
s.timeIntegration.newton.useModifiedNewton = True
s.solutionSettings.writeSolutionToFile = False
s.timeIntegration.verboseMode = 0
s.linearSolverType = exu.LinearSolverType.EigenSparse
began = time.process_time()
mbs.SolveDynamic(s)
seconds = time.process_time() - began
angle = mbs.GetNodeOutput(seen, exu.OutputVariableType.Coordinates)[2]
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


def straight_beam() -> object:
    """Return the clamped beam of segments, turning on each other."""
    from chain_examples import Springs  # type: ignore[import-not-found]

    from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System

    length = 1.0 / SEGMENTS
    bodies, across = [], MASS * length**2 / 12.0
    for k in range(SEGMENTS):
        parent, place = (f"segment_{k - 1}", (length, 0.0, 0.0)) if k else (GROUND, (0.0, 0.0, 0.0))
        joint = Joint("R2", f"segment_{k}.angle", start=0.0)
        com, inertia = (0.5 * length, 0.0, 0.0), (0.0, across, across)
        name = f"segment_{k}"
        bodies.append(Body(name, parent, place, (joint,), mass=MASS, com=com, inertia=inertia))
    rests = {f"segment_{k}.angle": 0.0 for k in range(SEGMENTS)}
    return System(
        "beam", ParameterTable(), tuple(bodies), parts=(Springs(rests, BENDING, LAG * BENDING),),
        gravity=(0.0, 0.0, -GRAVITY),
    )  # fmt: skip


def way(system: object, solver: str, rates: dict[str, float], seen: str, **settings: object) -> Run:
    """Return a function that runs a system and returns the sum of angles whose names begin so."""
    import numpy as np

    from vehicledyn.base.registry import find
    from vehicledyn.integrate.simulate import simulate
    from vehicledyn.kernel.make_kernel import compile_kernel
    from vehicledyn.multibody import derive

    kernel = compile_kernel(derive(system))  # type: ignore[arg-type]
    e = kernel.equations
    state = np.array([s.start for s in e.states])
    for k, variable in enumerate(e.states):
        if variable.name.endswith("_rate"):
            state[k] = rates.get(variable.name.partition("_")[0], 0.0)
    unknowns = np.array([u.start for u in e.unknowns])
    places = [
        k for k, s in enumerate(e.states) if s.name.startswith(seen) and s.name.endswith(".angle")
    ]

    def run(step: float) -> tuple[float, float]:
        last: list[float] = []
        own = settings if "relative_tolerance" in settings else {**settings, "step": step}
        began = time.process_time()
        simulate(
            kernel, find("solver", solver)(**own), start=0.0, stop=STOP,
            state=state, unknowns=unknowns, interval=0.5, watched=False,
            sink=lambda t, x, z, y: last.append(float(x[-1, places].sum())),
        )  # fmt: skip
        return last[-1], time.process_time() - began

    return run


def ours(kind: str, count: int, stiffness: float) -> tuple[dict[str, Run], float, float]:
    """Return the ways of vehicledyn, the exact angle and its amplitude [rad]."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "unit"))
    import vehicledyn.catalogue  # noqa: F401

    alpha = {"spectral_radius": RADIUS}
    if kind == "beam":

        def bent(solver: str, **settings: object) -> Run:
            return way(straight_beam(), solver, {}, "segment", **settings)

        fine = {"relative_tolerance": 1e-10, "absolute_tolerance": 1e-12}
        truth = bent("cvodes", **fine)(0.0)[0]
        ways = {
            "index 3": bent("generalised_alpha", constraints="index3", **alpha),
            "reduced": bent("generalised_alpha", **alpha),
        }
        return ways, truth, 0.25
    from chain_examples import chain

    turning = {"upright": RATE, "coupler": -RATE}
    inertia = (count + 1) / 3.0 + count
    amplitude = RATE / math.sqrt((2 * count + 1) * stiffness / inertia)
    multiplied = chain(count, method="multipliers", stiffness=stiffness)
    divided = chain(count, method="partitioning", stiffness=stiffness)
    seen = "upright_0.angle"
    ways = {
        "index 3": way(
            multiplied, "generalised_alpha", turning, seen, constraints="index3", **alpha
        ),
        "reduced": way(divided, "generalised_alpha", turning, seen, **alpha),
        "rk4": way(divided, "rk4", turning, seen),
    }
    return ways, exact(count, stiffness) - 0.5 * math.pi, amplitude


def theirs(python: str, given: list[object]) -> tuple[float, float]:
    """Run EXUDYN in its own interpreter."""
    call = [python, "-c", EXUDYN, json.dumps(given)]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    line = next(x for x in done.stdout.splitlines() if x.startswith("RESULT"))
    angle, seconds = json.loads(line.removeprefix("RESULT"))
    return angle, seconds


def main() -> None:
    """Print a table of steps, errors and times."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--exudyn", help="interpreter that has EXUDYN")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--stiffness", type=float, default=1e4)
    given = parser.parse_args()
    print(f"{'model':10} {'way':10} {'step [ms]':>10} {'error':>10} {'time [ms]':>10}")
    for kind, steps in STEPS.items():
        ways, truth, amplitude = ours(kind, given.count, given.stiffness)
        numbers = (
            [kind, SEGMENTS, BENDING, LAG * BENDING, MASS]
            if kind == "beam"
            else [kind, given.count, given.stiffness, 0.0, 1.0]
        )
        for step in steps:
            runs = {name: [run(step) for _ in range(3)] for name, run in ways.items()}
            if given.exudyn:
                more = [*numbers, RADIUS, STOP, RATE, step]
                found = [theirs(given.exudyn, more) for _ in range(3)]
                # Their four-bar turns from where ours stands upright.
                shift = 0.0 if kind == "beam" else 0.5 * math.pi
                runs["EXUDYN"] = [(angle - shift, seconds) for angle, seconds in found]
            for name, own in runs.items():
                error = abs(own[-1][0] - truth) / amplitude
                least = min(seconds for _, seconds in own)
                print(f"{kind:10} {name:10} {1e3 * step:10.3g} {error:10.2e} {1e3 * least:10.3g}")


if __name__ == "__main__":
    main()
