"""Show batches of cases how well constraints determine rates that no loop determines."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.rate_monitor import RateMonitor
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Vector = NDArray[np.float64]


def rate_monitor_of(
    equations: Equations, make_watch: Callable[[], PartitionMonitor]
) -> RateMonitor | None:
    """Return what watches the dependent rates of a model, None where it has none of its own."""
    structure: dict[str, Any] = equations.structure
    if not structure.get("rate_dependent"):
        return None
    watch = make_watch()
    place = {channel.name: k for k, channel in enumerate(equations.channels)}
    names = [name for name in watch.names if name in place]
    dependent = [*structure["dependent"], *structure["rate_dependent"]]

    def determinants(times: Vector, values: Vector) -> Vector:
        return watch.pivots(times, dict(zip(names, values.T, strict=True)), dependent)

    return RateMonitor([place[name] for name in names], determinants)
