"""Warn of beams whose shapes do not follow what a load at a place does there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.multibody.bodies.beam_shapes import Shapes
    from vehicledyn.multibody.elements.flexible.beam import Beam
    from vehicledyn.multibody.model.system import System

Floats = NDArray[np.float64]

SINKS_LESS, TWISTS_LESS = 5e-3, 0.05
"""Parts by which a place may sink or twist too little under a load there."""

TOO_LITTLE = "_too_little."
"""What stands in the name of the figure between what a beam does and the beam."""

_CURE = "take 'basis: attached', two beams that begin there, or 'model: segments'"

_MIDDLE = "its middle"
"""Where forces are judged that travel along a beam."""

_FINE, _POINTS = 40, 48
"""Degree of the polynomials that shapes are compared with, and points of a quadrature."""


@dataclass(frozen=True)
class CoarseShapes:
    """Shapes of a beam of which ``verb`` says what it does too little, "sinks" or "twists".

    ``missing`` is by which part, ``at`` the frame of the load, and ``count`` the number of shapes.
    """

    beam: str
    verb: str
    missing: float
    at: str
    count: int

    @property
    def name(self) -> str:
        """Name of the part as a figure of a run."""
        return f"{self.verb}{TOO_LITTLE}{self.beam}"

    @property
    def warning(self) -> str:
        """A warning that says by how much."""
        how = f"{100.0 * self.missing:.2g} % too little"
        if self.verb == "twists":
            place = f"under a torque at {self.at} it twists {how} there with {self.count} shapes"
            return f"warning: beam '{self.beam}': {place}; {_CURE}"
        cure = _CURE
        if self.at == _MIDDLE:
            cure = "take more modes, or 'basis: sines' where the ends are hinged"
        place = f"under a force at {self.at} it sinks {how} with {self.count} shapes"
        return f"warning: beam '{self.beam}': {place} on its foundation; {cure}"


def too_coarse(figure: str, largest: float, where: str) -> str:
    """Return a warning of a figure that :class:`CoarseShapes` names, with the cases it is of."""
    verb, beam = figure.split(TOO_LITTLE, 1)
    how = f"by up to {100.0 * largest:.2g} % too little under its loads in {where}"
    return f"warning: beam '{beam}': it {verb} {how}; {_CURE}"


@dataclass(frozen=True)
class LoadedBeams:
    """Beams of a system with the places over their lengths where something acts on them.

    ``numbers`` takes the parameters and returns for each beam its length, bending stiffness and
    foundation along y and z.
    """

    places: Sequence[tuple[Beam, dict[str, float]]] = ()
    numbers: Callable[[Floats], Floats] = np.asarray

    @staticmethod
    def of(prepared: Prepared) -> LoadedBeams:
        """Return those of a system whose shapes may be too coarse."""
        system = getattr(prepared.subject, "system", None)
        if system is None or not any(hasattr(part, "foundation") for part in system.parts):
            return LoadedBeams()
        from vehicledyn.multibody.elements.flexible.beam import Beam

        beams = [p for p in system.parts if isinstance(p, Beam) and p.model != "segments"]
        places = [(beam, loaded) for beam in beams if (loaded := _loaded(beam, system))]
        symbols = ops.column([entry.symbol for entry in system.table.entries])
        numbers = [item for beam, _ in places for item in _numbers(beam)]
        values = ops.numeric([symbols], ops.column(numbers)) if numbers else None
        return LoadedBeams(places, lambda p: np.zeros(0) if values is None else values(p)[:, 0])

    def coarse(self, parameters: Floats) -> list[CoarseShapes]:
        """Return the shapes that are too coarse with some parameters.

        That is the twist under a torque, and how a beam sinks into its foundation as in
        :func:`sinks`. Foundations whose line lies askew to the beam are not judged.
        """
        found = []
        values = self.numbers(parameters).reshape(len(self.places), -1) if self.places else ()
        for (beam, loaded), numbers in zip(self.places, values, strict=True):
            parts = [("sinks", *item) for item in _sinking(beam, loaded, numbers)]
            parts += [("twists", *item) for item in _twisting(beam, loaded)]
            found += [CoarseShapes(beam.name, verb, m, at, n) for verb, at, m, n in parts]
        return found


def coarse_shapes(prepared: Prepared) -> list[str]:
    """Return a warning for each beam that yields too little where something acts on it."""
    found = LoadedBeams.of(prepared).coarse(prepared.kernel.parameters)
    return [item.warning for item in found]


def _numbers(beam: Beam) -> list[Any]:
    """Return the length, the mean bending stiffnesses and those of the foundation, y and z."""
    bed = (0.0, 0.0) if beam.foundation is None else beam.foundation.stiffness[1:]
    moduli = [beam.properties.mean(d) for d in ("y", "z")]
    return [ops.scalar(item) for item in (beam.length, *moduli, *bed)]


def _twisting(beam: Beam, loaded: dict[str, float]) -> Iterator[tuple[str, float, int]]:
    """Yield the worst place, by how much it twists too little, and the number of shapes."""
    shapes, parts = beam.shapes_of("twist"), {}
    for name, place in loaded.items() if shapes.count else ():
        if name != _MIDDLE and place > 0.0:
            twist = shapes.values(place)
            parts[name] = 1.0 - float(twist @ (twist / shapes.stiffness)) / place
    yield from _worst(parts, TWISTS_LESS, shapes.count)


def _worst(parts: dict[str, float], least: float, count: int) -> Iterator[tuple[str, float, int]]:
    """Yield the largest of some parts if it is above the least."""
    name = max(parts, key=lambda name: parts[name], default="")
    if name and parts[name] > least:
        yield name, parts[name], count


def _sinking(
    beam: Beam, loaded: dict[str, float], values: Floats
) -> Iterator[tuple[str, float, int]]:
    """Yield the same of each direction of bending, of what sinks too little."""
    foundation = beam.foundation
    if foundation is None or foundation.direction is not None or foundation.upwards is not None:
        return
    held = foundation.begin, foundation.end
    for k, direction in enumerate(("y", "z")):
        shapes = beam.shapes_of(direction)
        stiff, bed = values[1 + k], values[3 + k] * values[0] ** 4
        if not shapes.count or not stiff > 0.0 or not bed > 0.0:
            continue
        parts = {
            name: 1.0
            - sinks(place, bed / stiff, held, shapes) / sinks(place, bed / stiff, held, None)
            for name, place in loaded.items()
        }
        yield from _worst(parts, SINKS_LESS, shapes.count)


def _loaded(beam: Beam, system: System) -> dict[str, float]:
    """Return the places over the length of the frames that something acts on."""
    from vehicledyn.multibody.elements.flexible.moving_load import MovingLoad
    from vehicledyn.multibody.model.parts import BasePart

    places = {f"{beam.name}.frame_{j + 1}": place for j, place in enumerate(beam.frames)}
    acting = [part for part in system.parts if type(part).loads is not BasePart.loads]
    named = {body.parent for body in system.bodies if body.name not in places}
    if any(isinstance(part, MovingLoad) and part.body == beam.name for part in system.parts):
        places[_MIDDLE], named = 0.5, named | {_MIDDLE}
    named |= {
        word for item in (*acting, *system.cuts, *system.constraints) for word in _words(item)
    }
    return {name: place for name, place in places.items() if name in named}


def _words(item: Any) -> Iterator[str]:
    """Yield the words that an element holds, of which some name bodies."""
    if isinstance(item, str):
        yield item
    elif isinstance(item, tuple | list):
        for entry in item:
            yield from _words(entry)
    elif is_dataclass(item):
        for known in fields(item):
            yield from _words(getattr(item, known.name, None))


def sinks(place: float, bed: float, held: tuple[float, float], shapes: Shapes | None) -> float:
    """Return how far a place moves under a force of one there, for E I = L = 1.

    The beam is free at both ends. Without shapes it bends as polynomials of a high degree do that
    have a kink at the place.

    Parameters
    ----------
    place
        Place over the length.
    bed
        Stiffness of the foundation k L⁴/(E I).
    held
        Where the foundation begins and ends over the length.
    shapes
        Shapes of the beam relative to its start.
    """
    from vehicledyn.multibody.bodies.beam_shapes import quadrature

    breaks = {place, *held, *(() if shapes is None else shapes.breaks)}
    nodes, weights = quadrature(_POINTS, tuple(sorted(a for a in breaks if 0.0 < a < 1.0)))

    def moved(places: Floats, order: int) -> Floats:
        if shapes is not None:
            rigid = np.array([places, np.ones_like(places)]) if order == 0 else 0.0 * places
            rigid = np.broadcast_to(rigid, (2, len(places))).T
            return np.hstack([rigid, shapes.at(places, order)])
        powers = legendre.legval(2.0 * places - 1.0, legendre.legder(np.eye(_FINE), order, scl=2.0))
        beyond = np.maximum(places - place, 0.0)
        return np.vstack([powers, beyond**3 if order == 0 else 6.0 * beyond]).T

    within = weights * (nodes >= held[0]) * (nodes <= held[1])
    flat, bent, here = moved(nodes, 0), moved(nodes, 2), moved(np.array([place]), 0)[0]
    springs = (bent.T * weights) @ bent + bed * (flat.T * within) @ flat
    sizes = np.sqrt(np.diag(springs))
    return float(here / sizes @ np.linalg.solve(springs / np.outer(sizes, sizes), here / sizes))
