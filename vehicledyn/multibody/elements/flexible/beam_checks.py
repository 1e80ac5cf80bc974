"""What no beam can be: contradictions of its sections, modes, axes and places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic.ops import Scalar

MOST_MODES = 12
"""Modes of a direction beyond which rounding makes the shapes of polynomials dependent."""
MOST_SINES = 24
"""The same of sines."""
MOST_SEGMENTS = 1000
DIRECTION_WORDS = {
    "y": "bending along y",
    "z": "bending along z",
    "twist": "twist",
    "stretch": "stretch",
    "shear_y": "shear along y",
    "shear_z": "shear along z",
}
_PARALLEL = 1e-9


def check_beam(beam: Any) -> None:
    """Refuse what no beam can be; numbers that are symbols are not judged.

    Parameters
    ----------
    beam
        A :class:`~vehicledyn.multibody.elements.flexible.beam.Beam`, which calls this.

    Raises
    ------
    InputError
        Begins with the field that it is about.
    """
    if (beam.section is None) == (beam.stiffness is None):
        found = "neither" if beam.section is None else "both"
        raise InputError(f"section: give a section or a stiffness, not {found}")
    if beam.section is not None and beam.material is None:
        raise InputError("material: missing; a section needs density and young of one")
    if beam.section is None and beam.material is not None:
        raise InputError("material: a beam given by its stiffness has none; leave it out")
    _check_end(beam)
    if not 1 <= beam.segments <= MOST_SEGMENTS:
        raise InputError(f"segments: {beam.segments:g} is not from 1 to {MOST_SEGMENTS}")
    outside = [place for place in beam.frames if not 0.0 <= place <= 1.0]
    if outside:
        words = f"frames: {outside[0]:g} is beyond the beam; places run from 0 to 1"
        raise InputError(f"{words} of its length")
    if beam.stresses and (beam.section is None or beam.model == "segments"):
        raise InputError(
            "stresses: follow from a section and assumed modes; give a section, not a "
            "stiffness, and 'model: modes' or 'exact'"
        )
    _check_axes(beam)
    _check_curvature(beam)
    _check_modes(beam)
    _check_attached(beam)
    _check_inertia(beam)


def _check_end(beam: Any) -> None:
    if beam.end_section is not None and beam.section is None:
        raise InputError("end_section: the beam is given by its stiffness; give end_stiffness")
    if beam.end_stiffness is not None and beam.stiffness is None:
        raise InputError("end_stiffness: the beam is given by its section; give end_section")
    if beam.section is None or beam.end_section is None:
        return
    shape, other = beam.section.shape, beam.end_section.shape
    if shape != other:
        raise InputError(f"end_section: is {other} where the start is {shape}; give one shape")


def _check_axes(beam: Any) -> None:
    """Refuse a beam that lies in no direction, or whose upwards is along it."""
    along, up = _numbers(beam.direction), _numbers(beam.upwards)
    for name, given in (("direction", along), ("upwards", up)):
        if given is not None and not any(given):
            raise InputError(f"{name}: is zero; give a vector that points somewhere")
    if along is None or up is None:
        return
    x, y, z = along
    a, b, c = up
    across = math.hypot(y * c - z * b, z * a - x * c, x * b - y * a)
    if across <= _PARALLEL * math.hypot(*along) * math.hypot(*up):
        raise InputError(
            "upwards: is along the beam and leaves open the plane of its x and z axes; give "
            "upwards another direction, such as [1, 0, 0] for a beam that stands upright"
        )


def _check_curvature(beam: Any) -> None:
    if beam.axis is None:
        return
    if beam.model == "modes":
        raise InputError(
            "curvature: shapes of small deflections are those of a straight beam; take "
            "'model: exact' or 'model: segments'"
        )
    if beam.foundation is not None:
        raise InputError("foundation: holds a beam to a line; a curved one has none")
    if beam.end_section is not None or beam.end_stiffness is not None:
        raise InputError("curvature: a tapered beam is straight; give a chain of beams")
    bent = _numbers(beam.curvature)
    if bent is None or beam.section is None:
        return
    reach = _numbers(beam.section.reach)
    if reach is None:
        return
    for axis, curvature, fibre in (("y", bent[1], reach[1]), ("z", bent[2], reach[0])):
        if abs(curvature) * fibre >= 1.0:
            raise InputError(
                f"curvature: about {axis} its radius of {1.0 / abs(curvature):g} m is not beyond "
                f"the section, which reaches {fibre:g} m; bend it less or make it thinner"
            )


def _check_modes(beam: Any) -> None:
    counts = beam.counts
    if beam.model != "exact" and counts["shear_y"] + counts["shear_z"]:
        raise InputError("modes: shear is for beams with 'model: exact'; leave it out")
    if beam.stiffening == "axial_force" and not counts["stretch"]:
        raise InputError("stiffening: an axial_force needs modes.stretch; give one or more")
    if not any(counts.values()):
        raise InputError("modes: the beam has none and would be rigid; give it some, or a body")
    for direction, count in counts.items():
        most = MOST_SINES if beam.basis == "sines" and direction in ("y", "z") else MOST_MODES
        if not 0 <= count <= most:
            raise InputError(
                f"modes.{direction}: {count} is not from 0 to {most}, beyond "
                "which shapes are not independent in double precision; use segments for more"
            )
        if count and beam.stiffness is not None and _vanishes(getattr(beam.numbers, direction)):
            raise InputError(
                f"stiffness.{direction}: the beam has modes of {DIRECTION_WORDS[direction]} and no "
                f"stiffness in it; give stiffness.{direction} or set modes.{direction} to 0"
            )


def _check_attached(beam: Any) -> None:
    """Refuse shapes with kinks where energies are summed over points that know nothing of them."""
    if beam.basis != "attached" or beam.model != "modes":
        return
    if beam.end_section is not None or beam.end_stiffness is not None:
        raise InputError(
            "basis: attached shapes of 'model: modes' are those of a uniform beam; give "
            "'basis: polynomials' or 'model: exact'"
        )


def _check_inertia(beam: Any) -> None:
    """Refuse turns of sections that no inertia resists, of a straight beam."""
    if beam.axis is None and beam.counts["twist"] and _vanishes(beam.numbers.polar):
        raise InputError(
            "stiffness.polar: the beam has modes of twist and no inertia about its axis; give "
            "stiffness.polar or set modes.twist to 0"
        )
    for way in ("y", "z"):
        shears, bends = beam.counts[f"shear_{way}"], beam.counts[way]
        if shears > 1 and bends and _vanishes(getattr(beam.numbers, f"rotary_{way}")):
            raise InputError(
                f"stiffness.rotary_{way}: sections that turn against the axis need an inertia; "
                f"give stiffness.rotary_{way}, or at most one mode of shear_{way}"
            )


def _vanishes(value: Scalar) -> bool:
    return isinstance(value, int | float) and value == 0.0


def _numbers(values: Sequence[Scalar]) -> list[float] | None:
    """Return a vector of numbers, None where some are symbols."""
    found = [float(item) for item in values if isinstance(item, int | float)]
    return found if len(found) == len(values) else None
