"""What a memory of cycles holds: the data classes that steps along branches take and return."""

from __future__ import annotations

from vehicledyn.analyse.periodic.basis import Basis
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.critical import CriticalPoint
from vehicledyn.analyse.periodic.cycle_points import CyclePoint
from vehicledyn.analyse.periodic.floquet import Multipliers
from vehicledyn.analyse.periodic.mirror_symmetry import Mirror
from vehicledyn.analyse.periodic.monodromy import Passages
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.settling.settling import Ending
from vehicledyn.analyse.settling.simulated_cycles import Settled

CYCLE_KINDS = (
    CriticalPoint,
    Basis,
    CyclePoint,
    Direction,
    Ending,
    Mirror,
    Multipliers,
    Orbit,
    Passages,
    Settled,
)
