"""Base of the tyre laws whose coefficients are in a tyre property file (.tir)."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import quantity
from vehicledyn.road.tyre_files.tyre_file import TyreFile, ValidRange, read_tyre_file
from vehicledyn.road.tyres.pacejka.coefficient_values import MIRRORED, Coefficients
from vehicledyn.road.tyres.pacejka.relaxation_lengths import (
    by_coefficients,
    by_stiffness,
    has_coefficients,
    has_stiffness,
)
from vehicledyn.road.tyres.pacejka.rolling_radii import (
    NEEDED,
    has_rolling_radius,
    rolling_radius_of_file,
)
from vehicledyn.road.tyres.pacejka.turn_slip import USED
from vehicledyn.road.tyres.scaling_factors import UNREAD, ScalingFactors
from vehicledyn.road.tyres.tyre import RelaxationLengths, Tyre, TyreForces, TyreInput
from vehicledyn.symbolic.ops import Scalar

OF_CHRONO = ("chrono", "chrono_vehicle")
"""Conventions with a combined slip of their own."""
_OTHER = {"left": "right", "right": "left"}
_NO_FORCES = TyreForces(0.0, 0.0, 0.0)


class FileTyre(Tyre):
    """Tyre whose coefficients come from a tyre property file.

    The file's numbers stand in the equations as constants; ``friction`` and ``pressure`` are
    parameters. A name without a folder that is not beside the scenario is looked for in the
    library. A tyre measured for one side of the car is mirrored on the other side.
    """

    versions: ClassVar[tuple[str, ...]] = ()
    """Versions of files that the law takes."""

    file: str = Field(
        description="Tyre property file (.tir), in the folder of the file that names it"
    )
    friction: float = quantity("1", "Factor of the friction, on λ_μx and λ_μy", default=1.0, gt=0)
    pressure: float | None = quantity(
        "Pa", "Inflation pressure, if not that of the file", default=None, gt=0
    )
    scaling: ScalingFactors = Field(
        default=ScalingFactors(), description="Scaling factors in place of those of the file"
    )
    convention: str | None = Field(
        default=None, description="Rules where public programs disagree, if not the usual ones"
    )
    mirror: Literal["by_side", "never", "always", "symmetric"] = Field(
        default="by_side",
        description="When the tyre is mirrored; 'symmetric' drops what differs from side to side",
    )

    acting: Literal["none", "longitudinal", "lateral", "uncombined", "combined"] | None = Field(
        default=None, description="Forces that act; without it those that USE_MODE asks for"
    )

    combined: Literal["ellipse", "pacejka", "none"] | None = Field(
        default=None,
        description="Combined slip by Chrono's rules; without it USE_MODE and FE_METHOD decide",
    )

    turn_slip: bool | None = Field(
        default=None,
        description="Whether turn slip acts, the curvature of the wheel's path, by the file's "
        "coefficients; camber then acts as a spin, too; without it USE_MODE decides",
    )

    rolling: Literal["loaded", "file"] | None = Field(
        default=None,
        description="Radius at which the wheel rolls: the loaded one, or by BREFF, DREFF and FREFF "
        "of the file; without it that of the convention, mostly the loaded one",
    )

    knows_turn_slip: ClassVar[bool] = False
    """Whether the law has turn slip."""

    @model_validator(mode="after")
    def _know_combination(self) -> Self:
        if self.combined is not None and self.convention not in OF_CHRONO:
            raise ValueError(
                "combined: a rule of Chrono; give 'convention: chrono', or 'acting: uncombined'"
            )
        return self

    @abstractmethod
    def steady_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces of a tyre that is not mirrored."""

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the forces at combined slip, in ISO 8855 signs."""
        p = self.coefficients()
        if self.mirror != "always":
            return self.acting_forces(p, contact)
        there = TyreInput(
            contact.normal_force,
            contact.longitudinal_slip,
            -contact.slip_angle,
            -contact.camber,
            contact.forward_speed,
            -contact.turn_slip,
        )
        found = self.acting_forces(p, there)
        return TyreForces(
            found.longitudinal_force,
            -found.lateral_force,
            -found.aligning_moment,
            -found.overturning_moment,
            found.rolling_resistance,
        )

    @property
    def forces_that_act(self) -> str:
        """Forces as this tyre names them, or as USE_MODE of the file does.

        A way to combine slips, where one is named, is not that of the file.
        """
        return self.acting or ("combined" if self.combined else self.content.asked.forces)

    @property
    def ellipse(self) -> Literal["shifted", "plain"] | None:
        """How slips combine by the friction ellipse, None where they do by weights.

        "shifted" as PAC2002 does where FE_METHOD says so; "plain" where the file has no
        coefficients of combined slip: forces at pure slip are then those of the pure curves.
        """
        method = self.content.texts.get("FE_METHOD", "").upper()
        if self.forces_that_act != "combined" or method == "NO":
            return None
        if method == "YES":
            return "shifted"
        return None if self.content.has_combined else "plain"

    def acting_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces that act; those without combined slip are at pure slip.

        The moment at pure side slip has no arm of the longitudinal force.
        """
        acts, along, across = self.forces_that_act, _NO_FORCES, _NO_FORCES
        if acts == "combined":
            return self.steady_forces(p, contact)
        if acts in ("longitudinal", "uncombined"):
            along = self.steady_forces(p, replace(contact, slip_angle=0.0))
        if acts in ("lateral", "uncombined"):
            upright = replace(contact, longitudinal_slip=0.0)
            across = self.steady_forces(p.changed(LS=0.0), upright)
        return replace(
            across,
            longitudinal_force=along.longitudinal_force,
            rolling_resistance=along.rolling_resistance,
        )

    def relaxation_lengths(self, contact: TyreInput) -> RelaxationLengths:
        """Return the lengths by the file's coefficients, or else by the carcass's stiffness.

        Raises
        ------
        InputError
            If the file has neither.
        """
        p = self.coefficients()
        if has_coefficients(p):
            return by_coefficients(p, contact)
        if has_stiffness(p):
            return by_stiffness(p, contact)
        raise InputError(
            f"{self.path}: no relaxation lengths: the file has neither PTX1, PTY1 and PTY2 nor "
            "LONGITUDINAL_STIFFNESS and LATERAL_STIFFNESS"
        )

    def rolling_radius(self, radius: Scalar, loaded_radius: Scalar, camber: Scalar) -> Scalar:
        """Return the loaded radius, or where ``rolling`` says so that of the file [m].

        Raises
        ------
        InputError
            If the file has none.
        """
        if self.rolling != "file":
            return super().rolling_radius(radius, loaded_radius, camber)
        p = self.coefficients()
        if not has_rolling_radius(p):
            raise InputError(
                f"{self.path}: rolling: the file has no rolling radius: it needs "
                f"{', '.join(NEEDED)} above zero; leave 'rolling' out"
            )
        return rolling_radius_of_file(p, radius, loaded_radius)

    def carcass_stiffness(self) -> tuple[float | None, float | None]:
        """Return LONGITUDINAL_STIFFNESS and LATERAL_STIFFNESS of the file [N/m]."""
        p = self.coefficients()
        if not has_stiffness(p):
            return None, None
        return p.LONGITUDINAL_STIFFNESS, p.LATERAL_STIFFNESS

    @property
    def has_overturning_moment(self) -> bool:
        """Whether the file has one that is not scaled to nothing."""
        return self.coefficients().LMX != 0.0 and super().has_overturning_moment

    @property
    def feels_turn_slip(self) -> bool:
        """Whether turn slip acts.

        Raises
        ------
        InputError
            If it is wanted, but the law has none, or the file no coefficients of it.
        """
        if self.turn_slip is None:
            return self.content.asked.turn_slip and self.has_turn_slip
        if not self.turn_slip:
            return False
        if not self.has_turn_slip:
            raise InputError(
                f"{self.path}: turn_slip: the file or its law has none; it takes Magic Formula 6.1 "
                f"or 6.2 with one of {', '.join(USED)}; leave turn_slip out"
            )
        return True

    @property
    def has_turn_slip(self) -> bool:
        """Whether the law has turn slip and the file coefficients of it."""
        if not self.knows_turn_slip:
            return False
        values = self.content.values
        return any(values.get(name, 0.0) != 0.0 for name in USED)

    def coefficients(self) -> Coefficients:
        """Return the file's coefficients with the changes of this tyre."""
        given, version = self.scaling.given(), self.content.version
        unread = [name for name in given if name in UNREAD[version]]
        if unread:
            words = f"Magic Formula {version} has no such factor; leave it out"
            raise InputError(f"{self.path}: scaling.{unread[0]}: {words}")
        p = Coefficients(self.content.values).changed(**given)
        changes: dict[str, Any] = {
            "LMUX": p.LMUX * self.friction,
            "LMUY": p.LMUY * self.friction,
        }
        if self.pressure is not None:
            if not self.content.has_pressure:
                raise InputError(
                    f"{self.path}: pressure: the file has none (NOMPRES in "
                    "[OPERATING_CONDITIONS]) that it would change; leave pressure out"
                )
            changes["INFLPRES"] = self.pressure
        if self.mirror == "symmetric":
            changes |= dict.fromkeys(MIRRORED, 0.0)
        return p.changed(**changes)

    @property
    def path(self) -> Path:
        """The file, in the library where there is none of the name beside the scenario."""
        path = Path(self.file)
        library = Path(str(files("vehicledyn.library.tyres"))) / path.name
        return library if not path.exists() and library.exists() else path

    @property
    def content(self) -> TyreFile:
        """What the file says.

        Raises
        ------
        InputError
            If it cannot be read or is of a version that the law does not take.
        """
        content = read_tyre_file(self.path)
        if self.versions and content.version not in self.versions:
            raise InputError(
                f"{self.path}: the file is of version {content.version}, the law '{self.kind}' "
                f"takes {' and '.join(self.versions)}; leave 'kind' out to take what fits the file"
            )
        return content

    @property
    def ranges(self) -> dict[str, ValidRange]:
        """Return the ranges in which the file holds, by quantity."""
        return self.content.ranges

    def placed(self, folder: Path) -> FileTyre:
        """Return the same tyre, its file looked for in a folder."""
        return self.model_copy(update={"file": str(folder / self.file)})

    def mounted(self, side: str) -> FileTyre:
        """Return the tyre on a side of the car: mirrored if it was measured for the other.

        A negative USE_MODE turns that round: the file describes the mirror image.
        """
        if self.mirror != "by_side":
            return self
        other = (_OTHER.get(side) == self.content.side) != self.content.asked.mirrored
        return self.model_copy(update={"mirror": "always" if other else "never"})

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the file, one line each."""
        try:
            placed = self.placed(folder)
            placed.steady_forces(placed.coefficients(), TyreInput(1.0, 0.0, 0.0, 0.0))
            _ = placed.feels_turn_slip
            placed.rolling_radius(0.3, 0.29, 0.0)
        except InputError as error:
            lines = str(error).splitlines()
            return lines[:-1] if len(lines) > 1 else lines
        return []


def convention_of(tyre: FileTyre, known: tuple[str, ...]) -> str:
    """Return the convention of a tyre, the first of those known unless it names one.

    Raises
    ------
    InputError
        If it names another one.
    """
    chosen = tyre.convention or known[0]
    if chosen not in known:
        raise InputError(f"{tyre.path}: {unknown_name('convention', chosen, known)}")
    return chosen
