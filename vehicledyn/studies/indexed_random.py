"""Random numbers and permutations that any part of a study finds without the parts before it.

Each number is a hash of seed, stream and index, so that a study of any size is made in pieces,
in any order, by any number of processes, and is always the same.

References
----------
Steele, Lea, Flood (2014), Fast splittable pseudorandom number generators, OOPSLA: the mixing.
Black, Rogaway (2002), Ciphers with arbitrary finite domains, CT-RSA: permutations of any number
of things by walking along the cycles of a Feistel network on a larger one.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Whole: TypeAlias = NDArray[np.int64]
Word: TypeAlias = NDArray[np.uint64]
Floats: TypeAlias = NDArray[np.float64]

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_ROUNDS = 8
_JITTER, _ORDER = 1, 2


def uniform(seed: int, stream: int | Whole, index: Whole) -> Floats:
    """Return numbers from 0 up to but without 1, of the shape of streams and index together.

    Parameters
    ----------
    seed
        Chooses the sequence.
    stream
        Number of the axis, or several; different ones are independent.
    index
        Number of each case, from 0.
    """
    words = _mix(_key(seed, stream, _JITTER) ^ _mix(index.astype(np.uint64)))
    return (words >> np.uint64(11)).astype(float) * 2.0**-53


def permutation(seed: int, stream: int | Whole, index: Whole, count: int) -> Whole:
    """Return where random permutations of ``0 ... count - 1`` take some of these numbers."""
    half = np.uint64(max(1, (count - 1).bit_length() + 1 >> 1))
    mask = (np.uint64(1) << half) - np.uint64(1)
    rounds = np.arange(_ROUNDS, dtype=np.uint64)
    keys, found = np.broadcast_arrays(_key(seed, stream, _ORDER), index.astype(np.uint64))
    found = found.copy()
    waiting = np.ones(found.shape, dtype=bool)
    while waiting.any():
        turns = _mix(keys[waiting][:, None] + rounds)
        found[waiting] = _feistel(found[waiting], half, mask, turns)
        waiting = found >= np.uint64(count)
    return found.astype(np.int64)


def latin_hypercube(seed: int, stream: int | Whole, index: Whole, count: int) -> Floats:
    """Return one number in each of ``count`` equal parts of 0 to 1, in random order.

    References
    ----------
    McKay, Beckman, Conover (1979), Technometrics 21(2), 239-245.
    """
    place = permutation(seed, stream, index, count).astype(float)
    return np.asarray((place + uniform(seed, stream, index)) / count)


def _feistel(words: Word, half: np.uint64, mask: np.uint64, turns: Word) -> Word:
    """Return words permuted by rounds with a key each, shape (n, n_rounds)."""
    left, right = words >> half, words & mask
    for turn in turns.T:
        left, right = right, left ^ (_mix(right ^ turn) & mask)
    return (left << half) | right


def _key(seed: int, stream: int | Whole, purpose: int) -> Word:
    key = np.array([seed], dtype=np.uint64)
    for part in (np.asarray(stream, dtype=np.uint64), np.uint64(purpose)):
        key = _mix(_mix(key) ^ part)
    return key


def _mix(words: Word) -> Word:
    mixed = words + _STEP
    mixed = (mixed ^ (mixed >> np.uint64(30))) * _FIRST
    mixed = (mixed ^ (mixed >> np.uint64(27))) * _SECOND
    return mixed ^ (mixed >> np.uint64(31))
