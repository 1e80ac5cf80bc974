"""Elastic foundations of beams: springs and dampers all along, after Winkler."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, vector
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Output, Wrench
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_GROUND = "ground"
POINTS_OF_A_SEGMENT = 2
"""Points of the quadrature in each segment."""


@dataclass(frozen=True, kw_only=True)
class Foundation:
    """Springs and dampers along a beam, which hold its axis to a line (Winkler 1867).

    With d the displacement of a point of the axis from its place on the line,

        f = -k d - c ḋ

    acts on each length, in the axes of the line: x along it, z upwards.
    """

    stiffness: Sequence[Scalar] = vector(
        "N/m^2", "Stiffness over length along x, y, z", nature="diagonal"
    )
    damping: Sequence[Scalar] = vector(
        "N*s/m^2", "Damping over length along x, y, z", default=ORIGIN, nature="diagonal"
    )
    begin: float = choice("Where it begins over the length of the beam, 0 to 1", default=0.0,
                          unit="1")  # fmt: skip
    end: float = choice("Where it ends, 0 to 1", default=1.0, unit="1")
    on: str = body_name("Body that carries it, or ground", default=_GROUND)
    at: Sequence[Scalar] | None = vector(
        "m", "Where its line has the start of the beam, in the axes of that body; needed where the "
        "beam is clamped to another one, else the beam's own", default=None,
    )  # fmt: skip
    direction: Sequence[Scalar] | None = vector(
        "1", "Along the line, in the axes of that body; as the beam's own", default=None
    )
    upwards: Sequence[Scalar] | None = vector(
        "1", "A direction in the plane of its x and z axes; as the beam's own", default=None
    )

    def __post_init__(self) -> None:
        """Refuse what no foundation can be."""
        if not 0.0 <= self.begin < self.end <= 1.0:
            raise InputError(
                f"foundation: runs from {self.begin:g} to {self.end:g}; begin and end are places "
                "over the length of the beam, from 0 to 1, and begin comes first"
            )
        for what in ("stiffness", "damping"):
            for value, axis in zip(getattr(self, what), "xyz", strict=True):
                if isinstance(value, int | float) and value < 0.0:
                    raise InputError(
                        f"foundation.{what}: is {value:g} along {axis}; a negative one gives "
                        "energy to the beam"
                    )


@dataclass(frozen=True)
class FoundedBeam:
    """A beam on its foundation.

    ``points`` is the number of points of the quadrature between ``breaks``, the places between
    segments or where shapes have kinks. ``line`` are at, direction and upwards of the beam.
    """

    name: str
    length: Scalar
    body: str
    foundation: Foundation
    points: int
    breaks: Sequence[float]
    line: tuple[Sequence[Scalar], Sequence[Scalar], Sequence[Scalar]]

    def __post_init__(self) -> None:
        """Refuse a line that nothing says."""
        f = self.foundation
        if f.on != self.body and f.at is None:
            raise InputError(
                f"foundation.at: missing; the beam is clamped to '{self.body}' and its foundation "
                f"stands on '{f.on}', so say where its line begins there"
            )

    @property
    def places(self) -> dict[str, float]:
        """Return the frames that the forces act on, with their places over the length."""
        return {name: place for name, place, _ in self._nodes()}

    def _nodes(self) -> Iterator[tuple[str, float, float]]:
        """Yield name, place and weight over the length of the points of the quadrature."""
        f, number = self.foundation, 0
        edges = [f.begin, *(place for place in self.breaks if f.begin < place < f.end), f.end]
        for first, last in pairwise(edges):
            for place, weight in zip(*quadrature(self.points), strict=True):
                number += 1
                span = last - first
                yield f"{self.name}.support_{number}", first + span * float(place), span * weight

    def wrenches(self, kinematics: Kinematics) -> Iterator[Wrench]:
        """Yield the forces on the beam, and their opposites on what carries the foundation."""
        for name, place, weight in self._nodes():
            state = self._state(kinematics, name, place)
            force = state.force * (float(weight) * self.length)
            own = state.rotation.T @ force
            yield Wrench(name, own, ops.vector(0.0, 0.0, 0.0))
            if self.foundation.on != _GROUND:
                yield Wrench(self.foundation.on, -force, ops.cross(state.foot, -force))

    def energy(self, kinematics: Kinematics) -> Scalar:
        """Return the energy of the springs [J]."""
        found = ops.scalar(0.0)
        for name, place, weight in self._nodes():
            moved = self._state(kinematics, name, place).displacement
            part = 0.5 * float(weight) * self.length
            for k in range(3):
                found = found + part * self.foundation.stiffness[k] * moved[k] * moved[k]
        return found

    def outputs(self, kinematics: Kinematics, frames: dict[str, float]) -> Iterator[Output]:
        """Yield energy and whole force, and the force over length at frames of the beam."""
        on, name = self.foundation.on, self.name
        text = f"Energy of the foundation of {name}"
        energy = Channel(f"{name}.foundation_energy", "J", text)
        yield Output(energy, self.energy(kinematics))
        whole = ops.vector(0.0, 0.0, 0.0)
        for point, place, weight in self._nodes():
            state = self._state(kinematics, point, place)
            whole = whole + state.force * (float(weight) * self.length)
        for k, axis in enumerate("xyz"):
            text = f"Force of the foundation on {name}, {axis}"
            yield Output(Channel(f"{name}.foundation_force_{axis}", "N", text, on), whole[k])
        for frame, place in frames.items():
            if self.foundation.begin <= place <= self.foundation.end:
                line = self._state(kinematics, frame, place).line_load
                for k, axis in enumerate("xyz"):
                    text = f"Force of the foundation over length at {frame}, {axis} of its line"
                    yield Output(Channel(f"{frame}.foundation_{axis}", "N/m", text), line[k])

    def _state(self, kinematics: Kinematics, frame: str, place: float) -> _State:
        f = self.foundation
        at, direction, upwards = (
            own if given is None else given
            for given, own in zip((f.at, f.direction, f.upwards), self.line, strict=True)
        )
        turn = _axes(direction, upwards)
        pair = kinematics.between(f.on, frame)
        rotation = pair.rotation(f.on)
        foot = rotation.T @ (pair.position(frame) - pair.position(f.on))
        along = turn @ ops.vector(place * self.length, 0.0, 0.0)
        displacement = turn.T @ (foot - ops.vector(*at) - along)
        rows: list[Scalar] = []
        for k in range(3):
            row = -f.stiffness[k] * displacement[k]
            if not ops.is_structurally_zero(ops.scalar(f.damping[k])):
                row = row - f.damping[k] * kinematics.time_derivative(displacement[k])
            rows.append(row)
        line_load = ops.vector(*rows)
        relative = rotation.T @ pair.rotation(frame)
        return _State(foot, displacement, line_load, turn @ line_load, relative)


@dataclass(frozen=True)
class _State:
    """Foot of a point in the axes of the carrier, displacement and load in those of the line.

    ``force`` is the load in the axes of the carrier, ``rotation`` R with v_carrier = R v_frame.
    """

    foot: Vec
    displacement: Vec
    line_load: Vec
    force: Vec
    rotation: Mat


def _axes(direction: Sequence[Scalar], upwards: Sequence[Scalar]) -> Any:
    if tuple(direction) == (1.0, 0.0, 0.0) and tuple(upwards) == (0.0, 0.0, 1.0):
        return rotations.identity()
    x = ops.unit(ops.vector(*direction))
    y = ops.unit(ops.cross(ops.vector(*upwards), x))
    return rotations.columns(x, y, ops.cross(x, y))
