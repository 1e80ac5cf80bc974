"""What a study file may say: a scenario, what varies in it, and what is kept of each case."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from vehicledyn.base.parameters import ParameterSet, part, quantity
from vehicledyn.base.registry import register

MOST_CASES = 10**12
LARGEST_SEED = 2**63 - 1
_SPAN: dict[str, Any] = {
    "type": "object",
    "properties": {
        "from": {"type": ["number", "string"]},
        "to": {"type": ["number", "string"]},
        "scale": {"enum": ["linear", "log"]},
    },
    "required": ["from", "to"],
    "additionalProperties": False,
}
_COUNTED: dict[str, Any] = {
    **_SPAN,
    "properties": {**_SPAN["properties"], "count": {"type": "integer", "minimum": 1}},
    "required": ["from", "to", "count"],
}
_VARY = "Dotted keys of the scenario, each with"


class StudyCases(ParameterSet):
    """Base of the ways to choose cases."""


@register("cases", "grid")
class Grid(StudyCases):
    """All combinations of given values; the last key varies fastest."""

    vary: dict[str, Any] = Field(
        description=f"{_VARY} a list of values, or 'from', 'to' and 'count'",
        json_schema_extra={"additionalProperties": {"anyOf": [{"type": "array"}, _COUNTED]}},
    )


@register("cases", "list")
class CaseList(StudyCases):
    """Cases one by one, written here or in a table."""

    rows: list[dict[str, Any]] | None = Field(
        default=None, description="One mapping a case, all with the same keys"
    )
    file: str | None = Field(
        default=None,
        description="CSV file in this folder; its first line names the keys, each with its unit "
        "in square brackets if it is not SI",
    )


@register("cases", "latin_hypercube")
class LatinHypercube(StudyCases):
    """Random values, one of each key in each of as many equal parts of its range as cases."""

    number: int = Field(description="Number of cases", ge=1, le=MOST_CASES)
    seed: int = Field(description="Chooses the random numbers", ge=0, le=LARGEST_SEED)
    vary: dict[str, Any] = Field(
        description=f"{_VARY} 'from' and 'to'", json_schema_extra={"additionalProperties": _SPAN}
    )


@register("cases", "random")
class Random(StudyCases):
    """Random values, each key evenly distributed over its range and independent of the others."""

    number: int = Field(description="Number of cases", ge=1, le=MOST_CASES)
    seed: int = Field(description="Chooses the random numbers", ge=0, le=LARGEST_SEED)
    vary: dict[str, Any] = Field(
        description=f"{_VARY} 'from' and 'to'", json_schema_extra={"additionalProperties": _SPAN}
    )


class StudyOutput(ParameterSet):
    """What the study's file keeps of each case."""

    interval: float | None = quantity(
        "s", "Time between two samples; the scenario's if left out", default=None, gt=0
    )
    channels: tuple[str, ...] | None = Field(
        default=None,
        description="Channels to keep, as shell patterns; the scenario's if left out, "
        "none if empty",
    )
    precision: Literal["double", "single"] = Field(
        default="double", description="'single' keeps samples as 32-bit numbers, half the size"
    )
    figures: bool = Field(default=True, description="Keep the key figures of each case")


class Study(ParameterSet):
    """Many runs of one scenario."""

    title: str = Field(description="What is studied, in a sentence")
    description: str = Field(default="", description="More about the study, for people")
    scenario: str = Field(description="Scenario file, in the same folder")
    set: dict[str, Any] = Field(
        default_factory=dict, description="Changes of the scenario for all cases, by dotted keys"
    )
    cases: StudyCases = part("cases", "What varies from case to case")
    output: StudyOutput = Field(
        default_factory=StudyOutput, description="What is kept of each case"
    )
    workers: int | None = Field(
        default=None,
        description="Processes, eight a core at most; one a core if left out",
        ge=1,
        le=4096,
    )
    lanes: Literal[1, 4, 8] | None = Field(
        default=None, description="Cases side by side in one process; what suits if left out"
    )
