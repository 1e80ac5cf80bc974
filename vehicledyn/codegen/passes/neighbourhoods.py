"""Colour the values of a graph so that those whose neighbourhoods look the same agree.

A colour is a number of 64 bits made of those of the operands and users, so that two
neighbourhoods that differ have the same one by chance in one of 10^19 cases only.

References
----------
Steele, Lea, Flood (2014), Fast splittable pseudorandom number generators, OOPSLA, pages 453-472:
the numbers are mixed as SplitMix64 mixes them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Colours = NDArray[np.uint64]

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_USER = np.uint64(0xD1B54A32D192ED03)


class Neighbourhoods:
    """The links of a graph, ready to colour its values round by round."""

    def __init__(
        self,
        operands: Sequence[Sequence[int]],
        turnable: Sequence[bool],
        users: Sequence[Sequence[int]],
    ) -> None:
        """Note the operands of each value, whether the first two may change places, its users."""
        below = [
            (value, operand, 0 if turns and place < 2 else place)
            for value, (given, turns) in enumerate(zip(operands, turnable, strict=True))
            for place, operand in enumerate(given)
        ]
        above = [(value, user) for value, found in enumerate(users) for user in found]
        self._below = np.array(below, dtype=np.int64).reshape(-1, 3)
        self._above = np.array(above, dtype=np.int64).reshape(-1, 2)
        self._places = _mixed(self._below[:, 2].astype(np.uint64) + np.uint64(1))

    def further(self, colours: Colours) -> Colours:
        """Return each value's colour made of its own, its operands' and its users'."""
        found = _mixed(colours)
        own, given, _ = self._below.T
        np.add.at(found, own, _mixed(colours[given] ^ self._places))
        own, user = self._above.T
        np.add.at(found, own, _mixed(colours[user] ^ _USER))
        return _mixed(found)


def first_colours(looks: Sequence[object]) -> Colours:
    """Return a colour for each value, the same for equal looks."""
    known: dict[object, int] = {}
    numbers = [known.setdefault(look, len(known)) for look in looks]
    return _mixed(np.array(numbers, dtype=np.uint64))


def _mixed(numbers: Colours) -> Colours:
    mixed = numbers + _STEP
    mixed = (mixed ^ (mixed >> np.uint64(30))) * _FIRST
    mixed = (mixed ^ (mixed >> np.uint64(27))) * _SECOND
    return np.asarray(mixed ^ (mixed >> np.uint64(31)), dtype=np.uint64)
