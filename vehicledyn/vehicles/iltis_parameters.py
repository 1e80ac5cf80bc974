"""Parameters of the Iltis, each with unit, meaning and bounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationInfo, field_validator

from vehicledyn.base.parameters import ParameterSet, Vector, quantity
from vehicledyn.base.yaml import read_yaml

_ROUNDING = 1e-9

DATA_FILE = Path(__file__).with_name("iltis.yaml")


class Chassis(ParameterSet):
    """The sprung mass."""

    mass: float = quantity("kg", "Mass of the chassis", gt=0)
    centre_of_mass: Vector = quantity("m", "Nominal position of the centre of mass")
    inertia_roll: float = quantity("kg*m^2", "Inertia about x", gt=0)
    inertia_pitch: float = quantity("kg*m^2", "Inertia about y", gt=0)
    inertia_yaw: float = quantity("kg*m^2", "Inertia about z", gt=0)

    @field_validator("inertia_yaw")
    @classmethod
    def _is_a_body(cls, value: float, info: ValidationInfo) -> float:
        return check_triangle(value, info, "inertia_roll", "inertia_pitch")


class Outline(ParameterSet):
    """Rectangle that holds the body seen from above."""

    front: float = quantity("m", "Front end ahead of the chassis centre of mass", gt=0)
    rear: float = quantity("m", "Rear end, negative behind the chassis centre of mass", lt=0)
    half_width: float = quantity("m", "Half the width of the body", gt=0)


class Hardpoints(ParameterSet):
    """Nominal points of the left corner; both hinge axes run along x."""

    wheel_centre: Vector = quantity("m", "Centre of the wheel")
    leaf_inner: Vector = quantity("m", "Hinge of the leaf spring on the chassis")
    leaf_outer: Vector = quantity("m", "Ball joint between leaf spring and carrier")
    a_arm_inner: Vector = quantity("m", "Hinge of the A-arm on the chassis")
    a_arm_outer: Vector = quantity("m", "Ball joint between A-arm and carrier")
    tie_rod_outer: Vector = quantity("m", "Tie rod at the carrier")
    tie_rod_inner: Vector = quantity("m", "Tie rod at the rack, or at the chassis")
    shock_upper: Vector = quantity("m", "Shock absorber at the chassis")
    shock_lower: Vector = quantity("m", "Shock absorber at the A-arm")


class Axle(ParameterSet):
    """What differs between front and rear."""

    hardpoints: Hardpoints
    tie_rod_adjustment: float = quantity(
        "m", "Length of the tie rod beyond the distance of its nominal points, sets the toe"
    )
    unloaded_radius: float = quantity("m", "Radius of the unloaded tyre", gt=0)


class AArm(ParameterSet):
    """Lower wishbone; its centre of mass lies on the line between its joints."""

    mass: float = quantity("kg", "Mass", gt=0)
    centre_of_mass: float = quantity(
        "m", "Distance of the centre of mass from the outer ball joint"
    )
    inertia_x: float = quantity("kg*m^2", "Inertia about x of the chassis", gt=0)
    inertia_along: float = quantity("kg*m^2", "Inertia about the line between the joints", gt=0)
    inertia_across: float = quantity("kg*m^2", "Inertia about the third axis", gt=0)

    @field_validator("inertia_across")
    @classmethod
    def _is_a_body(cls, value: float, info: ValidationInfo) -> float:
        return check_triangle(value, info, "inertia_x", "inertia_along")


class Wheel(ParameterSet):
    """Wheel with hub and carrier, a body of revolution."""

    mass: float = quantity("kg", "Mass", gt=0)
    inertia_spin: float = quantity("kg*m^2", "Inertia about the spin axis", gt=0)
    inertia_across: float = quantity("kg*m^2", "Inertia about a diameter", gt=0)
    vertical_stiffness: float = quantity("N/m", "Radial stiffness of the tyre", gt=0)
    vertical_damping: float = quantity("N*s/m", "Radial damping of the tyre", ge=0)

    @field_validator("inertia_across")
    @classmethod
    def _is_a_body(cls, value: float, info: ValidationInfo) -> float:
        return check_triangle(value, info, "inertia_spin", "inertia_across")


class LeafSpring(ParameterSet):
    """Vertical stiffness of the transverse leaf spring at its outer end, with bump stop."""

    anchor_height: float = quantity("m", "Nominal height of the chassis end of the length")
    stiffness: float = quantity("N/m", "Stiffness", gt=0)
    free_length: float = quantity("m", "Length without force")
    stop_length: float = quantity("m", "Length at which the bump stop touches")
    stop_stiffness: float = quantity("N/m", "Stiffness on the bump stop", gt=0)


class ShockAbsorber(ParameterSet):
    """Polynomial spring and damper of three branches."""

    spring_c0: float = quantity("N", "Spring force, constant term")
    spring_c1: float = quantity("N/m", "Spring force, linear term")
    spring_c2: float = quantity("N/m^2", "Spring force, quadratic term")
    spring_c3: float = quantity("N/m^3", "Spring force, cubic term")
    compression_limit: float = quantity("m/s", "Rate below which compression is linear", lt=0)
    compression_force: float = quantity("N", "Force of the compression line at zero rate")
    compression_slope: float = quantity("N*s/m", "Slope of the compression line")
    damping_c1: float = quantity("N*s/m", "Middle branch, linear term")
    damping_c2: float = quantity("N*s^2/m^2", "Middle branch, quadratic term")
    damping_c3: float = quantity("N*s^3/m^3", "Middle branch, cubic term")
    damping_c4: float = quantity("N*s^4/m^4", "Middle branch, quartic term")
    rebound_limit: float = quantity("m/s", "Rate above which rebound is linear", gt=0)
    rebound_force: float = quantity("N", "Force of the rebound line at zero rate")
    rebound_slope: float = quantity("N*s/m", "Slope of the rebound line")


class Steering(ParameterSet):
    """What a driver knows of the steering."""

    gain: float = quantity("rad/m", "Road-wheel angle, to the left, a rack displacement along +y")


class IltisParameters(ParameterSet):
    """All parameters of the Iltis."""

    gravity: float = quantity("m/s^2", "Acceleration of free fall", gt=0)
    chassis: Chassis
    outline: Outline
    front: Axle
    rear: Axle
    a_arm: AArm
    wheel: Wheel
    leaf_spring: LeafSpring
    shock_absorber: ShockAbsorber
    steering: Steering


def default_parameters() -> dict[str, Any]:
    """Return the content of the data file, with its units."""
    content: dict[str, Any] = read_yaml(DATA_FILE).data
    return content


def check_triangle(value: float, info: ValidationInfo, *others: str) -> float:
    """Return the last of three principal inertias if a body can have them.

    Parameters
    ----------
    value
        The inertia being read [kg m²].
    info
        What was read before it; a value that was refused is reported already and skipped.
    others
        Names of the other two; the field's own name where a body has the same value twice.

    Raises
    ------
    ValueError
        If one of the three exceeds the sum of the other two.
    """
    own = str(info.field_name)
    known = {**info.data, own: value}
    if not all(name in known for name in others):
        return value
    three = [(own, value), *((name, float(known[name])) for name in others)]
    name, largest = max(three, key=lambda item: item[1])
    rest = sum(number for _, number in three) - largest
    if largest > rest * (1.0 + _ROUNDING):
        raise ValueError(
            f"{name} = {largest:g} kg*m^2 exceeds the sum of the other two inertias, "
            f"{rest:g} kg*m^2: no body has that (triangle inequality)"
        )
    return value
