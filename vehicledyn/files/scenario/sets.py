"""What a scenario file may say: the vehicle, its parts, what it does and what is kept of it."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, field_validator

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import ParameterSet, part, quantity, read_part
from vehicledyn.base.ranges import read_range
from vehicledyn.base.registry import kinds
from vehicledyn.base.units import describe
from vehicledyn.files.scenario.model_names import is_written, known_models


class Tyres(ParameterSet):
    """Tyres by axle; left and right are equal."""

    front: ParameterSet = part("tyre", "Tyres of the front axle")
    rear: ParameterSet = part("tyre", "Tyres of the rear axle")


class Output(ParameterSet):
    """What the result file keeps and what is drawn from it."""

    interval: float = quantity("s", "Time between two samples of the result", gt=0)
    channels: tuple[str, ...] | None = Field(
        default=None, description="Channels to keep, as shell patterns; all if left out"
    )
    plots: tuple[str, ...] | None = Field(
        default=None, description="Figures to draw, by name; all of the run if left out"
    )
    animation: bool = Field(
        default=True,
        description="Whether the result keeps shapes and poses for 'vehicledyn animate'",
    )


class Kinematics(ParameterSet):
    """What the verb "kinematics" drives, and through which values."""

    drives: dict[str, str] = Field(
        description="Values of each driven coordinate or sensor: one, or FROM:TO:STEPS, such as "
        "-80 mm:80 mm:16"
    )
    together: bool = Field(
        default=False, description="Move the drives at once instead of through all combinations"
    )
    hold: tuple[str, ...] = Field(default=(), description="Coordinates that stay at their start")
    columns: tuple[str, ...] = Field(
        default=(), description="Channels that the table shows, as shell patterns"
    )

    @field_validator("drives", mode="before")
    @classmethod
    def _ranges(cls, value: Any) -> Any:
        if not isinstance(value, dict) or not value:
            raise ValueError(f"expected drives by the names of channels, found {describe(value)}")
        for name, text in value.items():
            try:
                read_range(str(text))
            except InputError as error:
                raise ValueError(f"{name}: {error}") from None
        return {name: str(text) for name, text in value.items()}


class Scenario(ParameterSet):
    """One run: a vehicle with its parts on a road, driven by a manoeuvre, or any system."""

    title: str = Field(description="What happens, in a sentence")
    description: str = Field(default="", description="More about the run, for people")
    model: str = Field(
        description="Name of a model, see 'vehicledyn models list', or a system file beside "
        "this one, such as my_system.yaml"
    )
    parameters: dict[str, Any] = Field(
        default_factory=dict, description="Changes of the model's parameters"
    )
    tyres: Tyres | None = Field(
        default=None, description="Tyre law: one for all wheels, or 'front' and 'rear'"
    )
    road: ParameterSet | None = part("road", "Surface of the road", default=None)
    track: ParameterSet | None = part("track", "Railway track of a system", default=None)
    creep: ParameterSet | None = part("creep", "Creep law of wheels on rails", default=None)
    rail_contact: ParameterSet | None = part("rail_contact", "How wheels touch rails", default=None)
    manoeuvre: ParameterSet | None = part("manoeuvre", "What the vehicle does", default=None)
    contact: Literal["disc", "vertical", "tangent_plane", "lowest_point"] | None = Field(
        default=None,
        description="How wheels touch the ground: 'disc' by geometry (the default), 'vertical' "
        "by the rules of the Iltis benchmark, 'tangent_plane' as 'vertical' with the contact "
        "point in the plane that touches the ground below the wheel centre, 'lowest_point' by "
        "that of the disc, as Chrono::Vehicle",
    )
    relaxation: ParameterSet | None = part(
        "relaxation", "Transient slip of the tyres; needed to stand on a slope", default=None
    )
    wheel_spin: Literal["free", "prescribed"] | None = Field(
        default=None, description="Whether the wheels turn freely or as the speed prescribes"
    )
    speed: float | None = quantity("m/s", "Speed at the start", default=None, ge=0)
    start: Literal["nominal", "static", "steady"] | None = Field(
        default=None,
        description="Where to start: 'nominal' as assembled (the usual of systems), in the "
        "equilibrium 'static' as standing, or 'steady' at the speed (the usual of vehicles)",
    )
    initial: dict[str, Any] = Field(
        default_factory=dict,
        description="Where coordinates of a system start, and rates under the coordinate's name "
        "with _rate",
    )
    duration: float = quantity("s", "Simulated time", gt=0)
    solver: ParameterSet = part("solver", "Integration method")
    output: Output = Field(description="What the result file keeps")
    kinematics: Kinematics | None = Field(
        default=None, description="What the verb 'kinematics' drives"
    )
    motion: dict[str, Any] | str | None = Field(
        default=None,
        description="Motion that the verb 'inverse' prescribes: by coordinate a law or an "
        "expression of time, or a table as CSV or result file",
    )

    @field_validator("parameters", "initial", mode="before")
    @classmethod
    def _nothing_is_no_change(cls, value: Any) -> Any:
        return {} if value is None else value

    @field_validator("track", mode="before")
    @classmethod
    def _track_file(cls, value: Any) -> Any:
        return {"kind": "file", "file": value} if isinstance(value, str) else value

    @field_validator("model")
    @classmethod
    def _know_model(cls, value: str) -> str:
        if value not in kinds("model") and not is_written(value):
            raise ValueError(unknown_name("model", value, known_models()))
        return value

    @field_validator("tyres", mode="before")
    @classmethod
    def _one_for_all(cls, value: Any) -> Any:
        if isinstance(value, dict) and not {"front", "rear"} & set(value):
            tyre = read_part("tyre", value)
            return Tyres(front=tyre, rear=tyre)
        if value is None or isinstance(value, dict | Tyres):
            return value
        raise ValueError(
            f"expected a mapping with 'kind', or with 'front' and 'rear', found {describe(value)}"
        )
