"""What a memory of cycles holds: the data classes that steps along branches take and return."""

from __future__ import annotations

from vehicledyn.solve.periodic.basis import Basis
from vehicledyn.solve.periodic.collocation import Direction
from vehicledyn.solve.periodic.cycle_points import CyclePoint
from vehicledyn.solve.periodic.floquet import Multipliers
from vehicledyn.solve.periodic.memory import Memory, Store
from vehicledyn.solve.periodic.mirror import Mirror
from vehicledyn.solve.periodic.monodromy import Passages
from vehicledyn.solve.periodic.orbit import Orbit
from vehicledyn.solve.periodic.settled import Settled
from vehicledyn.solve.periodic.settling import Ending

_KINDS = (Basis, CyclePoint, Direction, Ending, Mirror, Multipliers, Orbit, Passages, Settled)


def memory_of_cycles(store: Store) -> Memory:
    """Return a memory of cycles and simulated motions in a store."""
    return Memory(store, {kind.__name__: kind for kind in _KINDS})
