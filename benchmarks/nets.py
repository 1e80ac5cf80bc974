"""Time to prepare and to run nets of rods, by the number of points in a row.

    python benchmarks/nets.py 6 10 20

Prints the processor time to derive, compile and start a net that hangs at two corners, the time
of a step, and the errors of energy and constraints after a tenth of a second.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.registry import find
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "validation"))
STEP, DURATION = 1e-3, 0.1


def measure(count: int) -> str:
    """Return a line on the net of count by count points."""
    from nets import net

    started = time.process_time()
    system = net(count, count, pinned=((0, 0), (0, count - 1)), bend=0.02)
    equations = derive(system)
    derived = time.process_time()
    kernel = compile_kernel(equations)
    state = np.array([s.start for s in equations.states])
    outputs = kernel.outputs(0.0, state, [])
    prepared = time.process_time()
    found: list[np.ndarray] = [outputs[None]]
    statistics = simulate_monitored(
        system,
        kernel,
        find("solver", "rk4")(step=STEP),
        start=0.0,
        stop=DURATION,
        state=state,
        unknowns=np.zeros(0),
        interval=DURATION,
        sink=lambda t, x, z, y: found.append(y),
        progress=lambda what, part: None,
        happened=lambda what, at: None,
    )
    seconds = time.process_time() - prepared
    names = [c.name for c in equations.channels]
    table = np.vstack(found)
    energy = table[:, [names.index("energy.kinetic"), names.index("energy.gravity")]].sum(axis=1)
    gap = table[:, names.index("constraints.position_error")].max()
    return (
        f"{count:3d} by {count:<3d} {equations.structure['constraint_method']}: "
        f"derived {derived - started:.1f} s, prepared {prepared - started:.1f} s, "
        f"{1e3 * seconds / statistics.steps:.2f} ms a step, "
        f"energy error {np.ptp(energy):.1e} J, gap {gap:.0e} m, {kernel.description}"
    )


if __name__ == "__main__":
    for argument in sys.argv[1:] or ["6", "10", "20"]:
        print(measure(int(argument)), flush=True)
