"""A place of system files: a point of a body."""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from vehicledyn.files.expressions.expressions import origin
from vehicledyn.files.expressions.fields import SystemSet, Vector, measured, reference


class Place(SystemSet):
    """A point of a body; the name of a body alone is its origin."""

    body: str = reference("body", "The body, or ground")
    point: Vector = measured(
        "m", "The point in the axes of the body", default=origin(), nature="polar"
    )

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"body": value} if isinstance(value, str) else value
