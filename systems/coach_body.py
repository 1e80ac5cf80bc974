"""Write the car body of the flexible coach: run `python systems/coach_body.py`.

A free beam along the middle of a passenger coach, 25.2 m long with bolsters 19 m apart, whose mass
and moments of inertia are those of vehicle 1 of the Manchester Benchmarks: the ends beyond the
bolsters are the heavier. Its stiffness is an estimate that puts the first vertical bending at
8.5 Hz, lateral bending at 11 Hz and torsion at 12 Hz, as a coach may have. Nodes 1 to 25 go from
the rear to the front; 4 and 22 are at the bolsters, 13 in the middle. The origin is the centre of
mass.
"""

from __future__ import annotations

from pathlib import Path

from vehicledyn.multibody.bodies.finite_elements.beam_frames import BeamElement, Member, beam_frame
from vehicledyn.multibody.bodies.finite_elements.reading import write_archive

HALF_LENGTH, HALF_PIVOTS = 12.6, 9.5
ENDS, MIDDLE = 3, 18
"""Elements beyond each bolster, and between both."""
MASS, ROLL, PITCH = 32000.0, 56800.0, 1.97e6
BENDING, TORSION = (5.406e9, 3.228e9), 8.024e8
"""Of deflections sideways and up and down [N m²], and about the length [N m²]."""


def densities() -> tuple[float, float]:
    """Return the mass over the length of the ends and of the middle, by mass and pitch inertia."""
    outside, inside = 2.0 * (HALF_LENGTH - HALF_PIVOTS), 2.0 * HALF_PIVOTS
    far = 2.0 * (HALF_LENGTH**3 - HALF_PIVOTS**3) / 3.0
    near = 2.0 * HALF_PIVOTS**3 / 3.0
    end = (PITCH - near * MASS / inside) / (far - near * outside / inside)
    return end, (MASS - outside * end) / inside


def main() -> None:
    """Write the matrices beside this file."""
    step, inner = (HALF_LENGTH - HALF_PIVOTS) / ENDS, 2.0 * HALF_PIVOTS / MIDDLE
    rear = [-HALF_LENGTH + step * k for k in range(ENDS)]
    middle = [-HALF_PIVOTS + inner * k for k in range(MIDDLE + 1)]
    places = [(x, 0.0, 0.0) for x in (*rear, *middle, *(-x for x in reversed(rear)))]
    end, between = (
        BeamElement(
            axial=5e9,
            torsion=TORSION,
            bending=BENDING,
            mass=density,
            polar=ROLL / (2.0 * HALF_LENGTH),
        )
        for density in densities()
    )
    members = [
        Member(k, k + 1, between if ENDS < k <= ENDS + MIDDLE else end)
        for k in range(1, len(places))
    ]
    write_archive(beam_frame("coach_body", places, members), Path(__file__).with_suffix(".npz"))


if __name__ == "__main__":
    main()
