"""Deformable bodies from finite elements: frames, car bodies, arms, by their component modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import ClassVar, Literal

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Shape, Tube
from vehicledyn.multibody.bodies.finite_elements.interfaces import Motion
from vehicledyn.multibody.bodies.finite_elements.kept_models import (
    model_of,
    modes_of,
    standard_modes_of,
)
from vehicledyn.multibody.bodies.finite_elements.reduced_body import ReducedBody
from vehicledyn.multibody.bodies.finite_elements.reduced_modes import ReducedModes
from vehicledyn.multibody.joints.deformation import DEFORMATION
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.declaration import (
    ORIGIN,
    body_name,
    choice,
    file_name,
    group,
    number,
    vector,
)
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True, kw_only=True)
class Matrices:
    """Finite-element matrices in a file each: .mtx, .npy or a sparse .npz, in kg, m and s."""

    nodes: str = file_name("Table of number, x, y, z of each node (.csv, .txt, .npy)")
    mass: str = file_name("Mass matrix")
    stiffness: str = file_name("Stiffness matrix")
    damping: str | None = file_name("Damping matrix", default=None)
    dofs: str | None = file_name(
        "Table of node and direction, 1 to 6, of each row; without it the nodes have 3 or 6 "
        "directions each, in their order",
        default=None,
    )


@register("element_type", "flexible_body")
@dataclass(frozen=True, kw_only=True)
class FlexibleBody(BasePart):
    """A deformable body from the mass and stiffness matrices of a free finite-element structure.

    Its deformation are component modes (Craig, Bampton): static shapes of the interfaces and normal
    modes of the structure held there; or those of a file of standard input data. Other bodies,
    forces, wheels, sensors and cuts take hold of its frames, `<name>.<interface>` and
    `<name>.<node>`.
    """

    has_no_mirror_image: ClassVar[str] = "its matrices are not mirrored"

    body: str = body_name("Body that carries its frame, or ground")
    at: Sequence[Scalar] = vector(
        "m",
        "Where the origin of the matrices, or the reference interface, is in the axes of the body",
        default=ORIGIN,
    )
    direction: Sequence[Scalar] = vector(
        "1", "The x axis of the matrices, in the axes of the body", default=(1.0, 0.0, 0.0)
    )
    upwards: Sequence[Scalar] = vector(
        "1", "A direction in the plane of their x and z axes", default=(0.0, 0.0, 1.0)
    )
    file: str | None = file_name(
        "Archive of NumPy (.npz) with nodes and matrices, or standard input data of a body that is "
        "reduced already (.SID_FEM, .sid)",
        default=None,
    )
    matrices: Matrices | None = group("Files of nodes and matrices, in place of one", default=None)
    interface: dict[str, int | tuple[int, ...]] = choice(
        "Node that others take hold of, by the name of the interface, or nodes that a rigid piece "
        "joins to a frame in their middle"
    )
    interface_motion: Motion = choice(
        "Whether interfaces take forces and moments, or forces alone, with half the coordinates",
        default="all",
    )
    modes: int | None = choice(
        "Normal modes of the structure held at its interfaces; of standard input data the slowest "
        "modes to take, all without it",
        default=None,
        least=0,
    )
    reference: str | None = choice(
        "Interface at which the body is clamped to what carries it; without one the frame is the "
        "mean of its axes and the body moves as the joints of what carries it let it",
        default=None,
    )
    highest_frequency: float | None = choice(
        "Frequency above which component modes are left out", default=None, unit="Hz"
    )
    nodes: dict[str, int] | None = choice("Further nodes with a frame, by name", default=None)
    lines: tuple[tuple[int, ...], ...] = choice(
        "Nodes that the animation joins by lines, line by line", default=()
    )
    damping_ratio: Scalar = number("1", "Damping ratio of each mode", default=0.0, least=0.0)
    damping_ratios: tuple[float, ...] = choice(
        "Damping ratios of the first modes, in place of that of each", default=(), unit="1"
    )
    role: Literal["auto", "independent"] = choice(
        "Whether loops may determine some of its coordinates", default="auto"
    )

    def __post_init__(self) -> None:
        """Refuse what no body can be."""
        if (self.file is None) == (self.matrices is None):
            found = "neither" if self.file is None else "both"
            raise InputError(f"file: give an archive or matrices, not {found}")
        if self._is_standard:
            for name in ("reference", "interface_motion"):
                if getattr(self, name) not in (None, "all"):
                    words = "is for matrices; standard input data are reduced and have their frame"
                    raise InputError(f"{name}: {words}")
            pieces = [n for n, nodes in self.interface.items() if not isinstance(nodes, int)]
            if pieces:
                words = "give one node; standard input data cannot be joined any more"
                raise InputError(f"interface.{pieces[0]}: {words}")
        elif self.modes is None:
            raise InputError("modes: is missing; say how many normal modes the body takes")
        if not self.interface:
            raise InputError("interface: names no node; give those that others take hold of")
        if any(ratio < 0.0 for ratio in self.damping_ratios):
            raise InputError("damping_ratios: a ratio is negative; damping takes energy away")

    @property
    def _is_standard(self) -> bool:
        return self.file is not None and Path(str(self.file)).suffix.lower().startswith(".sid")

    @cached_property
    def component_modes(self) -> ReducedModes:
        """Modes of the structure, its frames and inertia integrals.

        Raises
        ------
        InputError
            If the files cannot be read, or the structure cannot be reduced as asked.
        """
        drawn = sorted({node for line in self.lines for node in line})
        kept = dict(self.nodes or {})
        lines = {f"node_{n}": n for n in drawn}
        if self._is_standard:
            return self._standard_modes(kept, lines)
        try:
            model = model_of(self._files)
        except InputError as error:
            raise InputError(f"{'matrices' if self.file is None else 'file'}: {error}") from None
        lost = [node for node in drawn if node not in model.index]
        if lost:
            raise InputError(
                f"lines: {model.source} has no node {lost[0]}; name nodes of the model"
            )
        highest = self.highest_frequency
        return modes_of(
            self._files,
            interface=dict(self.interface),
            modes=self.modes,
            reference=self.reference,
            kept={**kept, **lines},
            motion=self.interface_motion,
            highest=None if highest is None else 2.0 * math.pi * highest,
        )

    def _standard_modes(self, kept: dict[str, int], lines: dict[str, int]) -> ReducedModes:
        """Return the modes of standard input data that are wanted."""
        interface = {n: node for n, node in self.interface.items() if isinstance(node, int)}
        frames = {"interface": interface, "nodes": kept, "lines": lines}
        found = standard_modes_of(Path(str(self.file)), frames)
        count = len(found.frequencies)
        if self.modes is not None and not 0 < self.modes <= count:
            raise InputError(f"modes: the body has {count}; give 1 to {count}, or leave it out")
        wanted = count if self.modes is None else self.modes
        if self.highest_frequency is not None:
            limit = 2.0 * math.pi * self.highest_frequency
            wanted = min(wanted, int((found.frequencies <= limit).sum()))
        if not wanted:
            lowest = found.frequencies[0] / (2.0 * math.pi)
            raise InputError(f"highest_frequency: is below the lowest of the body, {lowest:.4g} Hz")
        return found.lowest(wanted)

    @property
    def _files(self) -> dict[str, Path]:
        if self.matrices is None:
            return {"archive": Path(str(self.file))}
        given = {f.name: getattr(self.matrices, f.name) for f in fields(self.matrices)}
        return {name: Path(file) for name, file in given.items() if file is not None}

    @cached_property
    def flexibility(self) -> ReducedBody:
        """The body as the recursions know it."""
        return ReducedBody(self.name, self.component_modes)

    @property
    def _ratios(self) -> list[Scalar]:
        count = len(self.component_modes.frequencies)
        if len(self.damping_ratios) > count:
            words = f"damping_ratios: are {len(self.damping_ratios)}, the body has {count} modes"
            raise InputError(f"{words}; give at most as many")
        rest = count - len(self.damping_ratios)
        return [*self.damping_ratios, *[self.damping_ratio] * rest]

    @property
    def _turns(self) -> tuple[Turn, ...]:
        """Return the turn from the axes of the body to those of the matrices."""
        if tuple(self.direction) == (1.0, 0.0, 0.0) and tuple(self.upwards) == (0.0, 0.0, 1.0):
            return ()
        x = ops.unit(ops.vector(*self.direction))
        y = ops.unit(ops.cross(ops.vector(*self.upwards), x))
        return (Turn(rotations.columns(x, y, ops.cross(x, y))),)

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the body and its frames."""
        found = self.flexibility
        frequencies = self.component_modes.frequencies / (2.0 * math.pi)
        joints = tuple(
            Joint(
                DEFORMATION,
                name,
                role=self.role,
                description=f"Mode {k + 1} of {self.name}, {frequencies[k]:.4g} Hz",
                settings={"measure": "m"},
            )
            for k, name in enumerate(found.coordinates)
        )
        matrix = found.inertia
        pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        root = Body(
            self.name,
            self.body,
            self.at,
            (*self._turns, *joints),
            mass=found.modes.mass,
            com=tuple(float(c) for c in found.centre),
            inertia=tuple(float(matrix[pair]) for pair in pairs),
            apparent_inertia=True,
            flexibility=found,
        )
        frames = (Body(f"{self.name}.{n}", self.name, place=k) for n, k in found.places.items())
        return (root, *frames)

    def loads(self, situation: Situation) -> Loads:
        """Return elastic and damping forces on the coordinates."""
        kinematics, names = situation.kinematics, self.flexibility.coordinates
        q, rates = ([of(name) for name in names] for of in (kinematics.coordinate, kinematics.rate))
        forces = self.flexibility.elastic_forces(q, rates, self._ratios)
        return Loads(joint_forces=dict(zip(names, forces, strict=True)))

    def shapes(self) -> tuple[Shape, ...]:
        """Return the lines between nodes of the deformed structure."""
        return tuple(
            Tube(
                f"{self.name}.line_{j + 1}_{k + 1}",
                Anchor(f"{self.name}.node_{a}"),
                Anchor(f"{self.name}.node_{b}"),
                None,
                "rod",
            )
            for j, line in enumerate(self.lines)
            for k, (a, b) in enumerate(pairwise(line))
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the strain energy, and how far frames are from where they are undeformed."""
        body, kinematics = self.flexibility, situation.kinematics
        q = [kinematics.coordinate(name) for name in body.coordinates]
        energy = Channel(f"{self.name}.strain_energy", "J", f"Strain energy of {self.name}")
        found = [Output(energy, body.energy(q))]
        for name in (*self.interface, *(self.nodes or {})):
            if name == self.reference:
                continue
            place = body.places[name]
            moved = body.deflection(place, q).position - ops.vector(*body.modes.frames[name][0])
            for k, axis in enumerate("xyz"):
                words = f"Deflection of {name} of {self.name}, {axis}"
                channel = Channel(f"{self.name}.{name}_{axis}", "m", words, self.name)
                found.append(Output(channel, moved[k]))
        return tuple(found)
