"""Scenario files: read YAML, validate it completely, resolve it to SI, describe it as a schema."""

from vehicledyn.scenario.load import (
    LoadedModel,
    LoadedScenario,
    is_system_file,
    load_model,
    load_scenario,
)
from vehicledyn.scenario.schema import scenario_schema
from vehicledyn.scenario.sets import Output, Scenario, Tyres

__all__ = [
    "LoadedModel",
    "LoadedScenario",
    "Output",
    "Scenario",
    "Tyres",
    "is_system_file",
    "load_model",
    "load_scenario",
    "scenario_schema",
]
