"""Warn of beams on foundations whose shapes do not follow how a force at a place sinks in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
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

COARSE = 5e-3
"""Part by which a place may sink too little under a force there."""

_MIDDLE = "its middle"
"""Where forces are judged that travel along a beam."""

_FINE, _POINTS = 40, 48
"""Degree of the polynomials that shapes are compared with, and points of a quadrature."""


def coarse_foundations(prepared: Prepared) -> list[str]:
    """Return a warning for each beam that sinks too little where something acts on it.

    As in :func:`sinks`, with the parameters of the prepared system. Foundations whose line lies
    askew to the beam are not judged.
    """
    system = getattr(prepared.subject, "system", None)
    if system is None or not any(hasattr(part, "foundation") for part in system.parts):
        return []
    from vehicledyn.multibody.elements.flexible.beam import Beam

    found = []
    for beam in (part for part in system.parts if isinstance(part, Beam)):
        if beam.foundation is None or beam.model == "segments":
            continue
        for name, missing, count in _missing(beam, system, prepared):
            cure = "'basis: attached', two beams that begin there, or 'model: segments'"
            if name == _MIDDLE:
                cure = "more modes, or 'basis: sines' where the ends are hinged"
            found.append(
                f"warning: beam '{beam.name}': under a force at {name} it sinks "
                f"{100.0 * missing:.2g} % too little with {count} shapes on its foundation; "
                f"take {cure}"
            )
    return found


def _missing(beam: Beam, system: System, prepared: Prepared) -> Iterator[tuple[str, float, int]]:
    """Yield the worst place of each direction of bending, by how much it sinks too little."""
    foundation = beam.foundation
    if foundation is None or foundation.direction is not None or foundation.upwards is not None:
        return
    table = system.table
    symbols = ops.column([entry.symbol for entry in table.entries])
    moduli = [beam.properties.mean(d) for d in ("y", "z")]
    numbers = ops.column([beam.length, *moduli, *foundation.stiffness[1:]])
    values = ops.numeric([symbols], numbers)(prepared.kernel.parameters)[:, 0]
    loaded = _loaded(beam, system)
    for k, direction in enumerate(("y", "z")):
        shapes = beam.shapes_of(direction)
        stiff, bed = values[1 + k], values[3 + k] * values[0] ** 4
        if not loaded or not shapes.count or not stiff > 0.0 or not bed > 0.0:
            continue
        held = foundation.begin, foundation.end
        parts = {
            name: 1.0
            - sinks(place, bed / stiff, held, shapes) / sinks(place, bed / stiff, held, None)
            for name, place in loaded.items()
        }
        worst = max(parts, key=lambda name: parts[name])
        if parts[worst] > COARSE:
            yield worst, parts[worst], shapes.count


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
    for known in fields(item) if is_dataclass(item) else ():
        value = getattr(item, known.name, None)
        for entry in value if isinstance(value, tuple | list) else (value,):
            if isinstance(entry, str):
                yield entry


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
