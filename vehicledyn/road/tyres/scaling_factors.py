"""Scaling factors of the Magic Formula that a scenario may give in place of those of the file."""

from __future__ import annotations

from vehicledyn.base.parameters import ParameterSet, quantity

_OF_61, _OF_PAC2002 = ("LKYC", "LKZC", "LMP"), ("LGAX", "LGAZ", "LKYG")
UNREAD = {"5.2": _OF_61, "pac2002": _OF_61, "6.1": _OF_PAC2002, "6.2": _OF_PAC2002}
"""Factors that the formulas of a version do not have."""


class ScalingFactors(ParameterSet):
    """Factors by their names in tyre property files; those left out are the file's.

    LGYR and LCZ are none: gyroscopic torques are those of the wheel's body, and its vertical
    stiffness is given beside the tyre.
    """

    LFZO: float | None = quantity("1", "Scale factor of nominal (rated) load", default=None, gt=0)
    LCX: float | None = quantity("1", "Scale factor of Fx shape factor", default=None, gt=0)
    LMUX: float | None = quantity(
        "1", "Scale factor of Fx peak friction coefficient", default=None, gt=0
    )
    LEX: float | None = quantity("1", "Scale factor of Fx curvature factor", default=None)
    LKX: float | None = quantity("1", "Scale factor of Fx slip stiffness", default=None)
    LHX: float | None = quantity("1", "Scale factor of Fx horizontal shift", default=None)
    LVX: float | None = quantity("1", "Scale factor of Fx vertical shift", default=None)
    LCY: float | None = quantity("1", "Scale factor of Fy shape factor", default=None, gt=0)
    LMUY: float | None = quantity(
        "1", "Scale factor of Fy peak friction coefficient", default=None, gt=0
    )
    LEY: float | None = quantity("1", "Scale factor of Fy curvature factor", default=None)
    LKY: float | None = quantity("1", "Scale factor of Fy cornering stiffness", default=None, gt=0)
    LHY: float | None = quantity("1", "Scale factor of Fy horizontal shift", default=None)
    LVY: float | None = quantity("1", "Scale factor of Fy vertical shift", default=None)
    LTR: float | None = quantity("1", "Scale factor of peak of pneumatic trail", default=None)
    LRES: float | None = quantity("1", "Scale factor for offset of residual torque", default=None)
    LXAL: float | None = quantity("1", "Scale factor of alpha influence on Fx", default=None)
    LYKA: float | None = quantity("1", "Scale factor of kappa influence on Fy", default=None)
    LVYKA: float | None = quantity("1", "Scale factor of kappa induced Fy", default=None)
    LS: float | None = quantity("1", "Scale factor of moment arm of Fx", default=None)
    LKYC: float | None = quantity("1", "Scale factor of camber force stiffness", default=None)
    LKZC: float | None = quantity("1", "Scale factor of camber torque stiffness", default=None)
    LVMX: float | None = quantity("1", "Scale factor of Mx vertical shift", default=None)
    LMX: float | None = quantity("1", "Scale factor of overturning couple", default=None)
    LMY: float | None = quantity("1", "Scale factor of rolling resistance torque", default=None)
    LMP: float | None = quantity("1", "Scale factor of Parking Moment", default=None)
    LGAX: float | None = quantity("1", "Scale factor of camber for Fx", default=None)
    LGAY: float | None = quantity("1", "Scale factor of camber for Fy", default=None)
    LGAZ: float | None = quantity("1", "Scale factor of camber for Mz", default=None)
    LSGKP: float | None = quantity("1", "Scale factor of Relaxation length of Fx", default=None)
    LSGAL: float | None = quantity("1", "Scale factor of Relaxation length of Fy", default=None)
    LMUV: float | None = quantity("1", "Decay of friction with sliding speed", default=None)
    LKYG: float | None = quantity("1", "Scale factor of camber in shifts (PAC2002)", default=None)

    def given(self) -> dict[str, float]:
        """Return the factors that are given, by name."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in values.items() if value is not None}
