"""Signs of modes that do not depend on the machine.

A mode and its opposite are the same motion. Libraries of linear algebra return one or the other,
by rounding, so that amplitudes would change sign from one processor to the next.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_ABOUT_LARGEST = 0.99
"""Share of the largest number that counts as large: in symmetric structures several are equal."""


def mode_signs(shapes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the signs that make the first of the largest numbers of each column positive.

    Parameters
    ----------
    shapes
        Displacements and rotations, or amplitudes, one column a mode; shape (n, modes).

    >>> mode_signs(np.array([[0.1, 0.2], [-2.0, 1.0], [1.999, 1.0]])).tolist()
    [-1.0, 1.0]
    """
    sizes = np.abs(shapes)
    first = np.argmax(sizes >= _ABOUT_LARGEST * sizes.max(axis=0), axis=0)
    found: NDArray[np.float64] = np.where(shapes[first, np.arange(shapes.shape[1])] < 0, -1.0, 1.0)
    return found
