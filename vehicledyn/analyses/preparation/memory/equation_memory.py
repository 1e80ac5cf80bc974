"""Equations of models as they were last derived for linear analyses, with their expressions.

An entry holds facts and expressions of the equations, their fingerprint and the key of the compiled
kernel; its name is a digest of all that they follow from. Points of which nothing is idle are kept
beside it, since only the derivation could look at them again. A missing, old or damaged entry is
ignored.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyses.preparation.memory.entries import read_entry, write_entry

MOST_EQUATIONS = 200
"""Models that are kept, the youngest."""

_EQUATIONS, _RESISTED = "equations", "resisted"


@dataclass(frozen=True)
class EquationMemory:
    """Facts, expressions and fingerprint of equations, and the key of their kernel.

    ``has_residuals`` and ``has_motion_residuals`` say whether the derivation can write the motion
    as residuals, with multipliers and of accelerations.
    """

    facts: dict[str, Any]
    expressions: dict[str, Any]
    has_residuals: bool
    has_motion_residuals: bool
    fingerprint: str
    kernel: str


def recall_equations(key: str) -> EquationMemory | None:
    """Return an entry, if there is a whole one that nobody else can have written."""
    content = read_entry(_EQUATIONS, key)
    try:
        return None if content is None else EquationMemory(**content)
    except TypeError:
        return None


def remember_equations(key: str, memory: EquationMemory) -> None:
    """Write an entry whole or not at all; a folder that cannot be written is no error."""
    write_entry(_EQUATIONS, key, dict(vars(memory)), MOST_EQUATIONS)


def is_resisted(key: str, *point: Any) -> bool:
    """Return whether all motions were found to have inertia at a point of the model of a key."""
    return read_entry(_RESISTED, _at(key, *point)) == {"resisted": True}


def remember_resisted(key: str, *point: Any) -> None:
    """Keep that all motions have inertia at a point of the model of a key."""
    write_entry(_RESISTED, _at(key, *point), {"resisted": True})


def _at(key: str, *point: Any) -> str:
    digest = hashlib.sha256(key.encode())
    for item in point:
        digest.update(np.ascontiguousarray(item, dtype=float).tobytes() + b";")
    return digest.hexdigest()[:32]
