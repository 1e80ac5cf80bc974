"""Arrays that are larger than the memory: in a file without a name that vanishes with its user."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def disk_array(folder: Path, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an array of zeros in a file in a folder, whose space is there from the begin on.

    Raises
    ------
    OSError
        If the disk has no space for it.
    """
    size = 8 * int(np.prod(shape, dtype=int))
    with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(file.fileno(), 0, max(size, 8))
        return np.memmap(file, np.float64, "r+" if size else "w+", shape=shape)
