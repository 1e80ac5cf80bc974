"""Write the ladder frame of the flexible truck: run `python systems/truck_frame.py`.

Two side rails 0.86 m apart and 6 m long, joined by five cross members, all of steel: estimates of
the order of a truck of 8 t, chosen for a demonstration. Nodes 1 to 13 are those of the left rail
from the front, 14 to 26 those of the right one, 27 to 31 the middles of the cross members; the
origin is between the front ends, x backwards is negative.
"""

from __future__ import annotations

from pathlib import Path

from vehicledyn.multibody.bodies.finite_elements.beam_frames import BeamElement, Member, beam_frame
from vehicledyn.multibody.bodies.finite_elements.reading import write_archive

YOUNG, SHEAR, DENSITY = 210e9, 80e9, 7850.0
LENGTH, HALF_WIDTH, PIECES = 6.0, 0.43, 12
CROSS_MEMBERS = (0, 3, 6, 9, 12)
"""Pieces of the rails, from the front, before each cross member."""


def channel(height: float, width: float, wall: float) -> BeamElement:
    """Return an open channel section, without the stiffness of its warping."""
    area = wall * (height + 2.0 * width)
    upright = wall * height**3 / 12.0 + width * wall * height**2 / 2.0
    aside = wall * width**3 / 6.0 + area * (0.2 * width) ** 2
    torsion = wall**3 * (height + 2.0 * width) / 3.0
    return BeamElement(
        axial=YOUNG * area,
        torsion=SHEAR * torsion,
        bending=(YOUNG * aside, YOUNG * upright),
        mass=DENSITY * area,
        polar=DENSITY * (upright + aside),
    )


def pipe(radius: float, wall: float) -> BeamElement:
    """Return a thin round section."""
    area, second = 6.283185307 * radius * wall, 3.141592654 * radius**3 * wall
    return BeamElement(
        axial=YOUNG * area,
        torsion=SHEAR * 2.0 * second,
        bending=(YOUNG * second, YOUNG * second),
        mass=DENSITY * area,
        polar=DENSITY * 2.0 * second,
    )


def main() -> None:
    """Write the matrices beside this file."""
    steps = [-LENGTH * k / PIECES for k in range(PIECES + 1)]
    places = [(x, side * HALF_WIDTH, 0.0) for side in (1.0, -1.0) for x in steps]
    places += [(steps[k], 0.0, 0.0) for k in CROSS_MEMBERS]
    count = PIECES + 1
    rail, cross = channel(0.22, 0.07, 0.007), pipe(0.05, 0.004)
    members = [
        Member(first + k, first + k + 1, rail) for first in (1, count + 1) for k in range(PIECES)
    ]
    for j, k in enumerate(CROSS_MEMBERS):
        middle = 2 * count + 1 + j
        members += [Member(1 + k, middle, cross), Member(middle, count + 1 + k, cross)]
    write_archive(beam_frame("truck_frame", places, members), Path(__file__).with_suffix(".npz"))


if __name__ == "__main__":
    main()
