"""General mechanics: bodies, joints, cuts, links, drives, sensors and their equations.

A system is built from plain values and derived once; every number entered in the parameter
table stays a symbol of the equations. A double pendulum of two rods, 1 m and 1 kg each:

>>> from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
>>> table = ParameterTable()
>>> length = table.add("length", 1.0, "m", "Length of each rod")
>>> mass = table.add("mass", 1.0, "kg", "Mass of each rod")
>>> def rod(name, parent, at):
...     across = mass * length * length / 12.0
...     joint = Joint("R2", f"{name}.angle", start=0.5)
...     return Body(name, parent, at, (joint,), mass=mass, com=(0.0, 0.0, -length / 2.0),
...                 inertia=(across, across, 0.0))
>>> upper = rod("upper", GROUND, (0.0, 0.0, 0.0))
>>> lower = rod("lower", "upper", (0.0, 0.0, -length))
>>> equations = derive(System("double pendulum", table, (upper, lower)))
>>> [state.name for state in equations.states]
['upper.angle', 'lower.angle', 'upper.angle_rate', 'lower.angle_rate']
>>> equations.rate.shape
(4, 1)

Importing this package loads no CasADi; :func:`derive` and the first parameter do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.door import door

if TYPE_CHECKING:
    from vehicledyn.multibody.constraints import (
        BaseConstraint,
        LinearConstraint,
        RateConstraint,
        UserConstraint,
    )
    from vehicledyn.multibody.cuts import BallCut, BodyCut, RodCut
    from vehicledyn.multibody.derivation import derive
    from vehicledyn.multibody.drives import ConstantRate, TimeLaw
    from vehicledyn.multibody.force_sensors import ConstraintForceSensor, ReactionSensor
    from vehicledyn.multibody.ground import GROUND
    from vehicledyn.multibody.links import Attachment, GuidedLink, Link
    from vehicledyn.multibody.parts import BasePart, Loads, Motion, Output, PartEvent, Wrench
    from vehicledyn.multibody.rolling import RollingWheel
    from vehicledyn.multibody.sensors import Accelerometer, BodySensor, SequenceSensor
    from vehicledyn.multibody.system import Body, Joint, System, Turn
    from vehicledyn.multibody.transmissions import belt, gears, rack, screw
    from vehicledyn.symbolic.parameters import ParameterTable

__all__ = [
    "GROUND",
    "Accelerometer",
    "Attachment",
    "BallCut",
    "BaseConstraint",
    "BasePart",
    "Body",
    "BodyCut",
    "BodySensor",
    "ConstantRate",
    "ConstraintForceSensor",
    "GuidedLink",
    "Joint",
    "LinearConstraint",
    "Link",
    "Loads",
    "Motion",
    "Output",
    "ParameterTable",
    "PartEvent",
    "RateConstraint",
    "ReactionSensor",
    "RodCut",
    "RollingWheel",
    "SequenceSensor",
    "System",
    "TimeLaw",
    "Turn",
    "UserConstraint",
    "Wrench",
    "belt",
    "derive",
    "gears",
    "rack",
    "screw",
]

# Loading a name's module when it is first used keeps the reading of files quick.
__getattr__ = door(
    __name__,
    {
        "vehicledyn.multibody.constraints": (
            "BaseConstraint",
            "LinearConstraint",
            "RateConstraint",
            "UserConstraint",
        ),
        "vehicledyn.multibody.rolling": ("RollingWheel",),
        "vehicledyn.multibody.transmissions": ("belt", "gears", "rack", "screw"),
        "vehicledyn.multibody.cuts": ("BallCut", "BodyCut", "RodCut"),
        "vehicledyn.multibody.derivation": ("derive",),
        "vehicledyn.multibody.drives": ("ConstantRate", "TimeLaw"),
        "vehicledyn.multibody.force_sensors": ("ConstraintForceSensor", "ReactionSensor"),
        "vehicledyn.multibody.links": ("Attachment", "GuidedLink", "Link"),
        "vehicledyn.multibody.parts": (
            "BasePart",
            "Loads",
            "Motion",
            "Output",
            "PartEvent",
            "Wrench",
        ),
        "vehicledyn.multibody.sensors": ("Accelerometer", "BodySensor", "SequenceSensor"),
        "vehicledyn.multibody.ground": ("GROUND",),
        "vehicledyn.multibody.system": ("Body", "Joint", "System", "Turn"),
        "vehicledyn.symbolic.parameters": ("ParameterTable",),
    },
)
