"""What USE_MODE of a tyre property file asks for: which forces, which dynamics, which contact.

The last digit names the forces: 0 none, 1 F_x and M_y, 2 F_y, M_x and M_z, 3 all without combined
slip, 4 all with it, 5 with turn slip, too. Tens name the dynamics, hundreds the contact; a minus
sign mirrors the tyre.

References
----------
Remarks in property files of PAC2002 and of MF-Tyre 5.2 and 6.1; help of Adams/Tire and RecurDyn.
"""

from __future__ import annotations

from dataclasses import dataclass

FORCES = ("none", "longitudinal", "lateral", "uncombined", "combined")
"""Forces that act, by the last digit; 5 is "combined", too."""

DYNAMICS = (
    "steady slip",
    "transient slip",
    "transient slip with a contact mass or non-linear relaxation",
    "a rigid ring",
)
"""Dynamics of the tyre, by the tens."""

_MOST_CONTACTS = 5
_TURN_SLIP = 5


@dataclass(frozen=True)
class UseMode:
    """A USE_MODE: forces, whether turn slip acts, place in :data:`DYNAMICS`, whether mirrored."""

    number: int = 4
    forces: str = "combined"
    turn_slip: bool = False
    dynamics: int = 0
    mirrored: bool = False


USUAL = UseMode()
"""All forces at combined and steady slip, which is also meant where a file says nothing."""


def use_mode(number: float) -> UseMode | None:
    """Return what a USE_MODE asks for; None if there is no such mode.

    >>> use_mode(-12)
    UseMode(number=-12, forces='lateral', turn_slip=False, dynamics=1, mirrored=True)
    """
    if number != int(number):
        return None
    size = abs(int(number))
    forces, dynamics, contact = size % 10, size // 10 % 10, size // 100
    if forces > _TURN_SLIP or dynamics >= len(DYNAMICS) or contact > _MOST_CONTACTS:
        return None
    turns = forces == _TURN_SLIP
    acting = FORCES[min(forces, len(FORCES) - 1)]
    return UseMode(int(number), acting, turns, dynamics, number < 0)
