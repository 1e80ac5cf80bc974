"""From a scenario to results: each function here is one verb of the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from vehicledyn.analyses.linear.eigenmodes import ModesReport, find_modes
    from vehicledyn.analyses.linear.equilibrium import EquilibriumReport, find_equilibrium
    from vehicledyn.analyses.models.describe import ModelReport, describe_model, write_system
    from vehicledyn.analyses.simulation.run_outcome import RunOutcome
    from vehicledyn.analyses.simulation.simulation import run_scenario

__all__ = [
    "EquilibriumReport",
    "ModelReport",
    "ModesReport",
    "RunOutcome",
    "describe_model",
    "find_equilibrium",
    "find_modes",
    "run_scenario",
    "write_system",
]

# Each verb loads its own modules only.
__getattr__ = lazy_exports(
    __name__,
    {
        "vehicledyn.analyses.linear.equilibrium": ("EquilibriumReport", "find_equilibrium"),
        "vehicledyn.analyses.models.describe": ("ModelReport", "describe_model", "write_system"),
        "vehicledyn.analyses.linear.eigenmodes": ("ModesReport", "find_modes"),
        "vehicledyn.analyses.simulation.run_outcome": ("RunOutcome",),
        "vehicledyn.analyses.simulation.simulation": ("run_scenario",),
    },
)
