"""Scenario files: read YAML, validate it completely, resolve it to SI, describe it as a schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.lazy_exports import lazy_exports
from vehicledyn.files.scenario.load import (
    LoadedModel,
    LoadedScenario,
    is_system_file,
    load_model,
    load_scenario,
)
from vehicledyn.files.scenario.model_names import known_models
from vehicledyn.files.scenario.sets import Output, Scenario, Tyres
from vehicledyn.files.scenario.target import Target

if TYPE_CHECKING:
    from vehicledyn.files.scenario.schema import scenario_schema

__all__ = [
    "LoadedModel",
    "LoadedScenario",
    "Output",
    "Scenario",
    "Target",
    "Tyres",
    "is_system_file",
    "known_models",
    "load_model",
    "load_scenario",
    "scenario_schema",
]

# Reading files takes no schema, whose makers take a while to load.
__getattr__ = lazy_exports(__name__, {"vehicledyn.files.scenario.schema": ("scenario_schema",)})
