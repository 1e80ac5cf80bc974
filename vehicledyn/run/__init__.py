"""From a scenario to results: each function here is one verb of the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.door import door

if TYPE_CHECKING:
    from vehicledyn.run.balance import EquilibriumReport, find_equilibrium
    from vehicledyn.run.describe import ModelReport, describe_model, write_system
    from vehicledyn.run.eigenmodes import ModesReport, find_modes
    from vehicledyn.run.simulation import RunOutcome, run_scenario

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
__getattr__ = door(
    __name__,
    {
        "vehicledyn.run.balance": ("EquilibriumReport", "find_equilibrium"),
        "vehicledyn.run.describe": ("ModelReport", "describe_model", "write_system"),
        "vehicledyn.run.eigenmodes": ("ModesReport", "find_modes"),
        "vehicledyn.run.simulation": ("RunOutcome", "run_scenario"),
    },
)
