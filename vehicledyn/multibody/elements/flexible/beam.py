"""Beams: straight or curved, uniform or tapered, by assumed modes or by rigid segments."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, ColouredTube, Shape, Tube
from vehicledyn.multibody.bodies.attached_shapes import attached_shapes
from vehicledyn.multibody.bodies.beam_inertia import rigid_inertia
from vehicledyn.multibody.bodies.beam_properties import (
    Material,
    Modes,
    Properties,
    Stiffness,
    section_stiffness,
    tapered_section,
    tapered_stiffness,
)
from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.bodies.beam_shapes import (
    SPARE,
    Shapes,
    assumed_shapes,
    free_shapes,
    hinged_shapes,
    points_of_a_part,
)
from vehicledyn.multibody.bodies.curved_axis import CurvedAxis
from vehicledyn.multibody.bodies.exact_beam import DIRECTIONS, ExactBeam
from vehicledyn.multibody.bodies.modal_beam import ModalBeam, Stiffening
from vehicledyn.multibody.bodies.segmented_beam import SegmentedBeam
from vehicledyn.multibody.elements.flexible.beam_checks import DIRECTION_WORDS, check_beam
from vehicledyn.multibody.elements.flexible.foundation import (
    POINTS_OF_A_SEGMENT,
    Foundation,
    FoundedBeam,
)
from vehicledyn.multibody.joints.deformation import DEFORMATION
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, group, number, vector
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

_DRAWN, _DRAWN_CURVED = 8, 16
"""Pieces that a beam of assumed modes is drawn of, straight or curved."""


@register("element_type", "beam")
@dataclass(frozen=True, kw_only=True)
class Beam(BasePart):
    """A beam, clamped at its start to a point of a body, that bends, twists and stretches.

    Axial forces, as of fast rotation, stiffen or buckle it. Other bodies, forces, sensors and cuts
    take hold of its frames: `<name>.tip` at its end, and `<name>.frame_1` and so on at the places
    `frames`. Its section is given by `section` and `material`, or by `stiffness`. A tapered beam
    has another one at its end, `end_section` or `end_stiffness`.
    """

    body: str = body_name("Body that it is clamped to, or ground")
    at: Sequence[Scalar] = vector("m", "Where it starts, in the axes of the body", default=ORIGIN)
    direction: Sequence[Scalar] = vector(
        "1", "Along the beam, its x axis, in the axes of the body", default=(1.0, 0.0, 0.0)
    )
    upwards: Sequence[Scalar] = vector(
        "1", "A direction in the plane of its x and z axes", default=(0.0, 0.0, 1.0)
    )
    length: Scalar = number("m", "Length, along the axis", above=0.0)
    curvature: Sequence[Scalar] = vector(
        "1/m",
        "Of the unloaded axis, an arc or helix: twist over length about x, curvature about y and "
        "about z, in the axes of any section; for 'model: exact' and 'segments'",
        default=ORIGIN, nature="sectional",
    )  # fmt: skip
    section: Section | None = group("Shape of the section", default=None)
    material: Material | None = group("Material", default=None)
    stiffness: Stiffness | None = group("Stiffness and mass, in place of a section", default=None)
    end_section: Section | None = group(
        "Section at the end of a tapered beam; sizes change linearly from the start", default=None
    )
    end_stiffness: Stiffness | None = group(
        "Stiffness and mass at the end; each changes linearly from the start", default=None
    )
    model: Literal["modes", "exact", "segments"] = choice(
        "Assumed modes of small deflections, of deflections of any size, or rigid segments with "
        "springs between them",
        default="modes",
    )
    modes: Modes = group("Modes of each direction; for segments, where they yield")
    basis: Literal["polynomials", "attached", "eigenfunctions", "free", "sines"] = choice(
        "Shapes of the modes: polynomials, these and one for the loads at each frame, "
        "eigenfunctions of the clamped beam, or for bending those of a free one beside "
        "polynomials, or sines, which stay on the first axis",
        default="polynomials",
    )
    stiffening: Stiffening = choice(
        "How axial forces act on bending: by the shortening of the bent axis, by an energy of the "
        "force in the stretch alone, or not at all",
        default="shortening",
    )
    segments: int = choice("Number of segments", default=16, least=1)
    role: Literal["auto", "independent"] = choice(
        "Whether loops may determine some of its coordinates, as where both ends are clamped",
        default="auto",
    )
    damping_ratio: Scalar = number("1", "Damping ratio of each mode", default=0.0, least=0.0)
    frames: tuple[float, ...] = choice(
        "Places over the length, 0 to 1, of further frames", default=(), unit="1"
    )
    stresses: bool = choice(
        "Whether stresses along it are channels, by which pictures colour it", default=False
    )
    foundation: Foundation | None = group(
        "Springs and dampers that hold it to a line all along", default=None
    )

    def __post_init__(self) -> None:
        """Refuse what no beam can be."""
        check_beam(self)

    @property
    def counts(self) -> dict[str, int]:
        """Number of modes of each direction."""
        return {direction: getattr(self.modes, direction) for direction in DIRECTIONS}

    @cached_property
    def numbers(self) -> Stiffness:
        """Stiffness and mass of the section."""
        if self.stiffness is not None:
            return self.stiffness
        if self.section is None or self.material is None:
            raise InputError("section: missing")
        return section_stiffness(self.section, self.material)

    @cached_property
    def properties(self) -> Properties:
        """Stiffness and mass over the length."""
        if self.end_section is None and self.end_stiffness is None:
            return Properties(self.numbers)
        return Properties(self.numbers, self._numbers_at)

    def section_at(self, place: float) -> Section | None:
        """Return the section at a place over the length; None of a beam given by stiffness."""
        if self.section is None or self.end_section is None:
            return self.section
        return tapered_section(self.section, self.end_section, place)

    def _numbers_at(self, place: float) -> Stiffness:
        section = self.section_at(place)
        if section is not None and self.material is not None:
            return section_stiffness(section, self.material)
        return tapered_stiffness(self.numbers, self.end_stiffness or self.numbers, place)

    @cached_property
    def _modal(self) -> ModalBeam | ExactBeam:
        made = {direction: self.shapes_of(direction) for direction in self.counts}
        if self.model == "exact":
            return ExactBeam(self.name, self.length, self.properties, made, self.axis)
        return ModalBeam(self.name, self.length, self.properties, made, self.stiffening)

    def shapes_of(self, direction: str) -> Shapes:
        """Return the assumed shapes of a direction."""
        count, bends = self.counts[direction], direction in ("y", "z")
        if bends and self.basis == "sines":
            return hinged_shapes(count)
        if bends and self.basis == "free":
            return free_shapes(count)
        if self.basis == "attached":
            return attached_shapes(count, 2 if bends else 1, self.frames)
        spare = SPARE if count and self.basis == "eigenfunctions" else 0
        return assumed_shapes(count, 2 if bends else 1, spare)

    @cached_property
    def _segmented(self) -> SegmentedBeam:
        yields = [direction for direction, count in self.counts.items() if count]
        whole = (self.name, self.length, self.properties)
        return SegmentedBeam(*whole, yields, self.segments, self.axis)

    @cached_property
    def axis(self) -> CurvedAxis | None:
        """The axis of a curved beam, None of a straight one."""
        if all(ops.is_structurally_zero(item) for item in self.curvature):
            return None
        return CurvedAxis(tuple(self.curvature), self.length)

    @cached_property
    def _founded(self) -> FoundedBeam | None:
        """The beam with its foundation; None of one without."""
        if self.foundation is None:
            return None
        breaks, points = self._segmented.joints, POINTS_OF_A_SEGMENT
        if self.model != "segments":
            breaks = list(self._modal.breaks)
            points = points_of_a_part(self._modal.points, len(breaks))
        line = (self.at, self.direction, self.upwards)
        return FoundedBeam(self.name, self.length, self.body, self.foundation, points, breaks, line)

    @property
    def _own_frames(self) -> dict[str, float]:
        """Places of the frames at which loads are reported."""
        return {f"{self.name}.frame_{j + 1}": place for j, place in enumerate(self.frames)}

    @property
    def _places(self) -> dict[str, float]:
        drawn = () if self.model == "segments" else range(1, self._pieces)
        line = {f"{self.name}.line_{k}": k / self._pieces for k in drawn}
        founded = {} if self._founded is None else self._founded.places
        return {**self._own_frames, **line, f"{self.name}.tip": 1.0, **founded}

    @property
    def _turns(self) -> tuple[Turn, ...]:
        """Return the turn from the axes of the body to those of the beam, none where they agree."""
        if tuple(self.direction) == (1.0, 0.0, 0.0) and tuple(self.upwards) == (0.0, 0.0, 1.0):
            return ()
        x = ops.unit(ops.vector(*self.direction))
        y = ops.unit(ops.cross(ops.vector(*self.upwards), x))
        return (Turn(rotations.columns(x, y, ops.cross(x, y))),)

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the beam, or its segments, and its frames."""
        if self.model == "segments":
            return self._segmented.bodies(self.body, self.at, self._turns, self._places)
        beam = self._modal
        joints = tuple(
            Joint(
                DEFORMATION,
                beam.coordinates[k],
                role=self.role,
                description=f"Mode {j + 1} of {DIRECTION_WORDS[direction]} of {self.name}",
                settings={"measure": "rad" if direction == "twist" else "m"},
            )
            for direction in beam.ranges
            for j, k in enumerate(beam.ranges[direction])
        )
        root = Body(
            self.name,
            self.body,
            self.at,
            (*self._turns, *joints),
            **rigid_inertia(self.properties, self.length, self.axis),
            apparent_inertia=True,
            flexibility=beam,
        )
        frames = (Body(name, self.name, place=place) for name, place in self._places.items())
        return (root, *frames)

    def loads(self, situation: Situation) -> Loads:
        """Return elastic and damping forces on the coordinates."""
        kinematics = situation.kinematics
        wrenches = () if self._founded is None else tuple(self._founded.wrenches(kinematics))
        if self.model == "segments":
            springs = self._segmented.forces(kinematics, self.damping_ratio)
            return Loads(wrenches=wrenches, joint_forces=springs)
        names = self._modal.coordinates
        q, rates = ([of(name) for name in names] for of in (kinematics.coordinate, kinematics.rate))
        forces = self._modal.elastic_forces(q, rates, ops.scalar(self.damping_ratio))
        return Loads(wrenches=wrenches, joint_forces=dict(zip(names, forces, strict=True)))

    def shapes(self) -> tuple[Shape, ...]:
        """Return the pieces between points of the deformed axis; segments draw themselves."""
        if self.model == "segments":
            return ()
        ends = [self.name, *(f"{self.name}.line_{k}" for k in range(1, self._pieces))]
        ends.append(f"{self.name}.tip")
        made: list[Shape] = []
        for k, (a, b) in enumerate(pairwise(ends)):
            name = self._piece(k)
            bar = (name, Anchor(a), Anchor(b), self._radius(k), "rod")
            made.append(ColouredTube(*bar, f"{name}.stress") if self.stresses else Tube(*bar))
        return tuple(made)

    @property
    def _pieces(self) -> int:
        return _DRAWN if self.axis is None else _DRAWN_CURVED

    def _piece(self, number: int) -> str:
        return f"{self.name}.piece_{number + 1}"

    def _radius(self, piece: int) -> Scalar | None:
        section = self.section_at((piece + 0.5) / self._pieces)
        return None if section is None else section.reach[0]

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return how far the end stands from where it is undeformed, in the axes of the start."""
        tip = f"{self.name}.tip"
        kinematics = situation.kinematics
        start = self._segmented.names[0] if self.model == "segments" else self.name
        pair = kinematics.between(start, tip)
        reach = pair.rotation(start).T @ (pair.position(tip) - pair.position(start))
        if self.axis is None:
            moved = ops.vector(reach[0] - self.length, reach[1], reach[2])
        else:
            moved = reach - self.axis.position(1.0)
        energy = Channel(f"{self.name}.strain_energy", "J", f"Strain energy of {self.name}")
        deflections = tuple(
            Output(
                Channel(
                    f"{tip}_{axis}", "m", f"Deflection of the end of {self.name}, {axis}", start
                ),
                moved[k],
            )
            for k, axis in enumerate("xyz")
        )
        found = [*deflections, Output(energy, self._strain_energy(kinematics))]
        if self._founded is not None:
            found += self._founded.outputs(kinematics, self._own_frames)
        return (*found, *self._section_outputs(kinematics))

    def _section_outputs(self, kinematics: Kinematics) -> Iterator[Output]:
        """Yield the loads of the sections at the start and the frames; segments have none."""
        if self.model == "segments":
            return
        q = [kinematics.coordinate(name) for name in self._modal.coordinates]
        places = {f"{self.name}.start": 0.0, **self._own_frames}
        for name, place in places.items():
            section = self.section_at(place)
            for channel, value in self._modal.loads(place, q).channels(name, section):
                yield Output(channel, value)
        for k in range(self._pieces if self.stresses else 0):
            place = (k + 0.5) / self._pieces
            section = self.section_at(place)
            if section is not None:
                text = f"Largest normal stress at {place:g} of the length of {self.name}, positive"
                stress = self._modal.loads(place, q).stress(section)
                yield Output(Channel(f"{self._piece(k)}.stress", "Pa", text), stress)

    def _strain_energy(self, kinematics: Kinematics) -> Scalar:
        if self.model == "segments":
            return self._segmented.energy(kinematics)
        return self._modal.energy([kinematics.coordinate(n) for n in self._modal.coordinates])
