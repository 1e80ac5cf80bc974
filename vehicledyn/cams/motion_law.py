"""The base of motion laws: a rise over an angle of the cam."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import Any

from pydantic import model_validator

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.cams.pieces import PieceCurve


class MotionLaw(ParameterSet):
    """Base of the motion laws of a follower over an angle of the cam."""

    over: float = quantity("rad", "Angle of the cam that it takes", gt=0.0)
    lift: float | None = quantity("m", "Rise, negative for a fall, of sliding ones", default=None)
    swing: float | None = quantity("rad", "Rise in angle, of rocking followers", default=None)

    @model_validator(mode="after")
    def _one_rise(self) -> Any:
        given = [n for n in ("lift", "swing") if getattr(self, n) is not None]
        if len(given) != 1:
            raise ValueError(
                "give either its lift, for a follower that slides, or its swing, for a rocker"
            )
        return self

    @property
    def rise(self) -> float:
        """What it rises by [m or rad]."""
        return self.lift if self.lift is not None else self.swing or 0.0

    @property
    def turns(self) -> bool:
        """Whether it is of a rocking follower; None where both will do."""
        return self.swing is not None

    def placed(self, begin: float, value: float) -> PieceCurve:
        """Return the law from an angle [rad] and value on."""
        rise = self.rise
        return PieceCurve(
            tuple(
                p.changed(begin + self.over * p.begin, self.over * p.width, rise, value)
                for p in self.curve().pieces
            )
        )

    @abstractmethod
    def curve(self) -> PieceCurve:
        """Return the law over 0 to 1, from 0 to 1.

        Raises
        ------
        ValueError
            If its numbers make no law.
        """

    def beside(self, folder: Path) -> MotionLaw:
        """Return the law with what its files hold, relative to a folder."""
        return self
