"""Parameter sets: each quantity is declared once with unit, meaning and bounds."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import describe, to_si

Vector = tuple[float, float, float]


def quantity(
    unit: str,
    description: str,
    *,
    default: Any = ...,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """Declare a quantity of a parameter set.

    Parameters
    ----------
    unit
        SI unit of the number inside the program, "1" for a pure number.
    description
        Meaning of the quantity, one phrase.
    default
        Only where physics or a convention gives one; without it the quantity is required.
    gt, ge, lt, le
        Bounds of the SI value. Do not use them with vectors.
    """
    return Field(
        default=default,
        description=description,
        json_schema_extra={"unit": unit},
        gt=gt,
        ge=ge,
        lt=lt,
        le=le,
    )


class ParameterSet(BaseModel):
    """Frozen set of parameters in SI units, read from values with units.

    Fields declared with :func:`quantity` accept a number (SI), a text with a unit, or for
    vectors a list of these. Every other key than the declared ones is refused.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    family: ClassVar[str] = ""
    kind: ClassVar[str] = ""

    @field_validator("*", mode="before")
    @classmethod
    def _read_unit(cls, value: Any, info: ValidationInfo) -> Any:
        unit = field_unit(cls, str(info.field_name))
        if unit is None or value is None:
            return value
        try:
            if isinstance(value, list | tuple):
                return tuple(to_si(item, unit) for item in value)
            if isinstance(value, dict):
                raise InputError(f"expected a number in {unit}, found {describe(value)}")
            return to_si(value, unit)
        except InputError as error:
            raise ValueError(str(error)) from None


def field_unit(parameters: type[ParameterSet], name: str) -> str | None:
    """Return the unit a field was declared with, or None if it is not a quantity."""
    extra = parameters.model_fields[name].json_schema_extra
    return str(extra["unit"]) if isinstance(extra, dict) and "unit" in extra else None
