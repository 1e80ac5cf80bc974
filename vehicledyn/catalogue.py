"""All catalogues at once: importing this module registers every part that a scenario may name."""

from __future__ import annotations

import vehicledyn.manoeuvres
import vehicledyn.models
import vehicledyn.road
import vehicledyn.solve
from vehicledyn.base.registry import families, kinds

__all__ = ["families", "kinds"]
