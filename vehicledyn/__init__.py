"""Road- and rail-vehicle dynamics from symbolic multibody equations.

>>> import vehicledyn as vd
>>> motion = vd.simulate("double_pendulum", duration="0.1 s")
>>> motion["upper.angle"].unit
'rad'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.lazy_exports import lazy_exports
from vehicledyn.base.version import VERSION

if TYPE_CHECKING:
    from vehicledyn.base.errors import (
        AccuracyWarning,
        InputError,
        MissingPartError,
        NumericalError,
        ResultWarning,
        UnfinishedWarning,
        VehicledynError,
    )
    from vehicledyn.interface.cams import cam
    from vehicledyn.interface.comparing import compare
    from vehicledyn.interface.contacts import contact_geometry
    from vehicledyn.interface.documents import models, report, write_equations
    from vehicledyn.interface.handling import handling, steady
    from vehicledyn.interface.hunting import hunt
    from vehicledyn.interface.identification import identify, identify_study
    from vehicledyn.interface.linear import equilibrium, linearise, modes, response
    from vehicledyn.interface.loading import load
    from vehicledyn.interface.manoeuvres import optimise_manoeuvre
    from vehicledyn.interface.mechanism import inverse, kinematics, rig
    from vehicledyn.interface.optimisation import optimise
    from vehicledyn.interface.plugins import load_plugin
    from vehicledyn.interface.sensitivities import sensitivity
    from vehicledyn.interface.simulation import simulate
    from vehicledyn.interface.studies import sweep
    from vehicledyn.interface.uncertainties import uncertainty, uncertainty_study
    from vehicledyn.interface.views import track, tyre
    from vehicledyn.multibody.model.bodies import Body, Joint, Turn
    from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
    from vehicledyn.multibody.model.ground import GROUND
    from vehicledyn.multibody.model.parts import BasePart
    from vehicledyn.multibody.model.system import System
    from vehicledyn.results.labelled.array import LabelledArray
    from vehicledyn.results.labelled.data import LabelledData, open_result
    from vehicledyn.symbolic.parameters import ParameterTable

__all__ = [
    "GROUND",
    "AccuracyWarning",
    "BallCut",
    "BasePart",
    "Body",
    "BodyCut",
    "InputError",
    "Joint",
    "LabelledArray",
    "LabelledData",
    "MissingPartError",
    "NumericalError",
    "ParameterTable",
    "ResultWarning",
    "RodCut",
    "System",
    "Turn",
    "UnfinishedWarning",
    "VehicledynError",
    "__version__",
    "cam",
    "compare",
    "contact_geometry",
    "equilibrium",
    "handling",
    "hunt",
    "identify",
    "identify_study",
    "inverse",
    "kinematics",
    "linearise",
    "load",
    "load_plugin",
    "models",
    "modes",
    "open_result",
    "optimise",
    "optimise_manoeuvre",
    "report",
    "response",
    "rig",
    "sensitivity",
    "simulate",
    "steady",
    "sweep",
    "track",
    "tyre",
    "uncertainty",
    "uncertainty_study",
    "write_equations",
]

_HOMES = {
    "vehicledyn.base.errors": (
        "AccuracyWarning",
        "InputError",
        "MissingPartError",
        "NumericalError",
        "ResultWarning",
        "UnfinishedWarning",
        "VehicledynError",
    ),
    "vehicledyn.interface.cams": ("cam",),
    "vehicledyn.interface.comparing": ("compare",),
    "vehicledyn.interface.contacts": ("contact_geometry",),
    "vehicledyn.interface.documents": ("models", "report", "write_equations"),
    "vehicledyn.interface.handling": ("handling", "steady"),
    "vehicledyn.interface.hunting": ("hunt",),
    "vehicledyn.interface.identification": ("identify", "identify_study"),
    "vehicledyn.interface.linear": (
        "equilibrium",
        "linearise",
        "modes",
        "response",
    ),
    "vehicledyn.interface.mechanism": (
        "inverse",
        "kinematics",
        "rig",
    ),
    "vehicledyn.interface.studies": ("sweep",),
    "vehicledyn.interface.loading": ("load",),
    "vehicledyn.interface.manoeuvres": ("optimise_manoeuvre",),
    "vehicledyn.interface.optimisation": ("optimise",),
    "vehicledyn.interface.plugins": ("load_plugin",),
    "vehicledyn.interface.sensitivities": ("sensitivity",),
    "vehicledyn.interface.simulation": ("simulate",),
    "vehicledyn.interface.uncertainties": ("uncertainty", "uncertainty_study"),
    "vehicledyn.interface.views": ("track", "tyre"),
    "vehicledyn.multibody.model.bodies": ("Body", "Joint", "Turn"),
    "vehicledyn.multibody.model.cuts": ("BallCut", "BodyCut", "RodCut"),
    "vehicledyn.multibody.model.ground": ("GROUND",),
    "vehicledyn.multibody.model.parts": ("BasePart",),
    "vehicledyn.multibody.model.system": ("System",),
    "vehicledyn.results.labelled.array": ("LabelledArray",),
    "vehicledyn.results.labelled.data": ("LabelledData", "open_result"),
    "vehicledyn.symbolic.parameters": ("ParameterTable",),
}

__version__ = VERSION

# Importing the package loads nothing: each name loads its module when it is first used.
if not TYPE_CHECKING:  # for type checkers there are no other names than those above
    __getattr__ = lazy_exports(__name__, _HOMES)


def __dir__() -> list[str]:
    """Return the names offered, for completion."""
    return sorted(__all__)
