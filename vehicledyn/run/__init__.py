"""From a scenario to results: each function here is one verb of the command line."""

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
