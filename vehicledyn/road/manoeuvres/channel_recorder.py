"""What a summary is made from: the channels a manoeuvre asked for, over all samples of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Recording:
    """Samples of a run: ``time``, shape (n,) [s], and channels by name, shape (n,), in SI.

    ``units`` are those of the channels, by name.
    """

    time: NDArray[np.float64]
    channels: Mapping[str, NDArray[np.float64]]
    units: dict[str, str] = field(default_factory=dict)
