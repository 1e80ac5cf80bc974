"""Coefficients of the Magic Formula of 1987, in the paper's numbering and units."""

from __future__ import annotations

from pydantic import ConfigDict

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.road.tyres.coefficients import read_coefficients

_PAPER = read_coefficients("magic_formula_1987")
_FY, _MZ, _FX = _PAPER["lateral"], _PAPER["aligning"], _PAPER["longitudinal"]


class LateralCoefficients(ParameterSet):
    """a1 to a13 of the side force; without other values those of the paper's tyre."""

    model_config = ConfigDict(validate_default=True)

    a1: float = quantity("N/kN^2", "Peak: change of friction with load", default=_FY["a1"])
    a2: float = quantity("N/kN", "Peak: friction at no load", default=_FY["a2"], gt=0)
    a3: float = quantity("N/deg", "Stiffness: largest value", default=_FY["a3"])
    a4: float = quantity("1", "Stiffness: shape over load", default=_FY["a4"])
    a5: float = quantity("1/kN", "Stiffness: scale of load", default=_FY["a5"])
    a6: float = quantity("1/kN^2", "Curvature: load squared", default=_FY["a6"])
    a7: float = quantity("1/kN", "Curvature: load", default=_FY["a7"])
    a8: float = quantity("1", "Curvature at no load", default=_FY["a8"])
    a9: float = quantity("1", "Horizontal shift per camber", default=_FY["a9"])
    a10: float = quantity(
        "N/(kN^2 deg)", "Vertical shift per camber and load squared", default=_FY["a10"]
    )
    a11: float = quantity("N/(kN deg)", "Vertical shift per camber and load", default=_FY["a11"])
    a12: float = quantity("1/deg", "Stiffness factor lost per camber", default=_FY["a12"])
    a13: float = quantity("1/deg", "Curvature gained per camber", default=_FY["a13"])


class AligningCoefficients(ParameterSet):
    """a1 to a13 of the aligning moment; without other values those of the paper's tyre."""

    model_config = ConfigDict(validate_default=True)

    a1: float = quantity("N m/kN^2", "Peak: load squared", default=_MZ["a1"])
    a2: float = quantity("N m/kN", "Peak: load", default=_MZ["a2"])
    a3: float = quantity("N m/(kN^2 deg)", "Stiffness: load squared", default=_MZ["a3"])
    a4: float = quantity("N m/(kN deg)", "Stiffness: load", default=_MZ["a4"])
    a5: float = quantity("1/kN", "Stiffness: decay with load", default=_MZ["a5"])
    a6: float = quantity("1/kN^2", "Curvature: load squared", default=_MZ["a6"])
    a7: float = quantity("1/kN", "Curvature: load", default=_MZ["a7"])
    a8: float = quantity("1", "Curvature at no load", default=_MZ["a8"])
    a9: float = quantity("1", "Horizontal shift per camber", default=_MZ["a9"])
    a10: float = quantity(
        "N m/(kN^2 deg)", "Vertical shift per camber and load squared", default=_MZ["a10"]
    )
    a11: float = quantity("N m/(kN deg)", "Vertical shift per camber and load", default=_MZ["a11"])
    a12: float = quantity("1/deg", "Stiffness factor lost per camber", default=_MZ["a12"])
    a13: float = quantity("1/deg", "Curvature gained per camber", default=_MZ["a13"])


class LongitudinalCoefficients(ParameterSet):
    """a1 to a8 of the longitudinal force; without other values those of the paper's tyre."""

    model_config = ConfigDict(validate_default=True)

    a1: float = quantity("N/kN^2", "Peak: change of friction with load", default=_FX["a1"])
    a2: float = quantity("N/kN", "Peak: friction at no load", default=_FX["a2"], gt=0)
    a3: float = quantity("N/(kN^2 %)", "Stiffness: load squared", default=_FX["a3"])
    a4: float = quantity("N/(kN %)", "Stiffness: load", default=_FX["a4"])
    a5: float = quantity("1/kN", "Stiffness: decay with load", default=_FX["a5"])
    a6: float = quantity("1/kN^2", "Curvature: load squared", default=_FX["a6"])
    a7: float = quantity("1/kN", "Curvature: load", default=_FX["a7"])
    a8: float = quantity("1", "Curvature at no load", default=_FX["a8"])
