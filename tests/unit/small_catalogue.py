"""Throw-away catalogue: a small vehicle, two tyres, a manoeuvre with a driver, two solvers."""

from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from vehicledyn.base.parameters import ParameterSet, Vector, part, quantity
from vehicledyn.base.yaml import read_yaml

SCENARIO = """\
title: A cart drives around cones
model: cart
parameters:
  chassis:
    mass: 1.2 t
tyres: {kind: linear, stiffness: 30 kN}
road:
  kind: flat
manoeuvre:
  kind: slalom
  spacing: 18 m
  driver:
    kind: preview
    preview: 0.5 s
wheel_spin: free
speed: 36 km/h
duration: 12 s
solver:
  kind: fixed
  step: 1 ms
output:
  interval: 10 ms
  channels: [chassis.*]
"""


class Body(ParameterSet):
    """A body of the cart."""

    mass: float = quantity("kg", "Mass", gt=0)
    centre: Vector = quantity("m", "Centre of mass in the body frame")
    inertia: Vector = quantity("kg m^2", "Principal moments of inertia")

    @model_validator(mode="after")
    def _triangle(self) -> "Body":
        if 2 * max(self.inertia) > sum(self.inertia):
            raise ValueError("the inertia breaks the triangle inequality")
        return self


class CartParameters(ParameterSet):
    """Parameters of the cart."""

    chassis: Body
    wheel_radius: float = quantity("m", "Radius of the wheels", gt=0)
    controller: ParameterSet = part("driver", "Speed controller")


class Cart:
    """A cart whose parameters are kept in this file."""

    parameter_class = CartParameters
    defaults: dict[str, Any] = {  # noqa: RUF012
        "chassis": {"mass": 1000.0, "centre": [0.1, 0.0, "500 mm"], "inertia": [1.0, 2.0, 2.5]},
        "wheel_radius": 0.3,
        "controller": {"kind": "fixed_wheel", "angle": 0.0},
    }

    @classmethod
    def default_parameters(cls) -> dict[str, Any]:
        return cls.defaults


class BrokenCart:
    """A cart whose parameter file is wrong; tests set the path."""

    parameter_class = CartParameters
    parameter_file: Path

    @classmethod
    def default_parameters(cls) -> dict[str, Any]:
        return dict(read_yaml(cls.parameter_file).data)


class Linear(ParameterSet):
    """Linear tyre."""

    stiffness: float = quantity("N", "Cornering stiffness", gt=0)


class Rigid(ParameterSet):
    """Tyre without slip."""


class Flat(ParameterSet):
    """Flat ground."""


class Preview(ParameterSet):
    """Driver who looks ahead."""

    preview: float = quantity("s", "Preview time", gt=0)
    style: Literal["calm", "brisk"] = Field(default="calm", description="Style of the driver")


class FixedWheel(ParameterSet):
    """Driver who holds the wheel."""

    angle: float = quantity("rad", "Angle of the steering wheel")


class Slalom(ParameterSet):
    """Slalom around cones."""

    spacing: float = quantity("m", "Distance of the cones", gt=0)
    count: int = Field(default=9, description="Number of cones", ge=1)
    offsets: tuple[float, ...] = quantity("m", "Sideways shift of each cone", default=())
    driver: ParameterSet = part("driver", "Who steers")
    helpers: tuple[ParameterSet, ...] = part("driver", "Others", default=())


class FixedStep(ParameterSet):
    """Fixed step."""

    step: float = quantity("s", "Step", gt=0)


class Adaptive(ParameterSet):
    """Adaptive step."""

    relative_tolerance: float = quantity("1", "Relative tolerance", gt=0, lt=1)


ENTRIES = (
    ("model", "cart", Cart),
    ("model", "broken_cart", BrokenCart),
    ("tyre", "linear", Linear),
    ("tyre", "rigid", Rigid),
    ("road", "flat", Flat),
    ("driver", "preview", Preview),
    ("driver", "fixed_wheel", FixedWheel),
    ("manoeuvre", "slalom", Slalom),
    ("solver", "fixed", FixedStep),
    ("solver", "adaptive", Adaptive),
)
