"""Whether wheels ran at angles of attack that the windows of their contacts do not count with."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike

from vehicledyn.multibody.model.parts import Part
from vehicledyn.rail.contact.wheel_grid import count_windows
from vehicledyn.rail.contact.wheel_on_rail import ElasticWheels

_STEP = 1e-3


def attack_remarks(parts: Iterable[Part], channels: Mapping[str, ArrayLike]) -> Iterator[str]:
    """Yield remarks on wheels whose contacts had too few windows for how they ran.

    Windows are those of a rigid wheel at the angle at which the axle ran, in whole milliradians
    up: were there more of them than the equations have, two contacts were taken for one.

    Parameters
    ----------
    parts
        The parts of the system that ran.
    channels
        Samples of its channels, shape (n,); axles without ``angle_of_attack`` are passed over.
    """
    for part in parts:
        if not isinstance(part, ElasticWheels):
            continue
        samples = channels.get(f"{part.name}.angle_of_attack")
        if samples is None or not np.size(samples):
            continue
        attack = float(np.abs(samples).max())
        if not math.isfinite(attack):
            continue
        asked = _STEP * math.ceil(attack / _STEP)
        if asked <= part.contact.grid.attack:
            continue
        wanted = count_windows(*part.wheels.geometry(), asked)
        if wanted > len(part.contact.grid.shares):
            yield (
                f"'{part.name}' ran at angles of attack up to {1e3 * attack:.3g} mrad, at which "
                f"its contacts jump elsewhere: give rail_contact.angle_of_attack: "
                f"{1e3 * asked:.0f} mrad"
            )
