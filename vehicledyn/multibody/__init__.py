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

from vehicledyn.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from vehicledyn.multibody.elements.drives import ConstantRate, TimeLaw
    from vehicledyn.multibody.elements.force_sensors import ConstraintForceSensor, ReactionSensor
    from vehicledyn.multibody.elements.motion_sensors import (
        Accelerometer,
        BodySensor,
        SequenceSensor,
    )
    from vehicledyn.multibody.elements.point_forces import Attachment, PointForce
    from vehicledyn.multibody.elements.rolling import RollingWheel
    from vehicledyn.multibody.elements.transmissions import Belt, Gears, LeadScrew, Rack
    from vehicledyn.multibody.equations.derivation import derive
    from vehicledyn.multibody.model.bodies import Body, Joint, Turn, quaternion_joint
    from vehicledyn.multibody.model.constraints import (
        BaseConstraint,
        LinearConstraint,
        RateConstraint,
        UserConstraint,
    )
    from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
    from vehicledyn.multibody.model.ground import GROUND
    from vehicledyn.multibody.model.parts import (
        BasePart,
        DrivenMotion,
        Loads,
        Output,
        PartEvent,
        Wrench,
    )
    from vehicledyn.multibody.model.system import System
    from vehicledyn.symbolic.parameters import ParameterTable

__all__ = [
    "GROUND",
    "Accelerometer",
    "Attachment",
    "BallCut",
    "BaseConstraint",
    "BasePart",
    "Belt",
    "Body",
    "BodyCut",
    "BodySensor",
    "ConstantRate",
    "ConstraintForceSensor",
    "DrivenMotion",
    "Gears",
    "Joint",
    "LeadScrew",
    "LinearConstraint",
    "Loads",
    "Output",
    "ParameterTable",
    "PartEvent",
    "PointForce",
    "Rack",
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
    "derive",
    "quaternion_joint",
]

# Loading a name's module when it is first used keeps the reading of files quick.
__getattr__ = lazy_exports(
    __name__,
    {
        "vehicledyn.multibody.model.constraints": (
            "BaseConstraint",
            "LinearConstraint",
            "RateConstraint",
            "UserConstraint",
        ),
        "vehicledyn.multibody.elements.rolling": ("RollingWheel",),
        "vehicledyn.multibody.elements.transmissions": ("Belt", "Gears", "LeadScrew", "Rack"),
        "vehicledyn.multibody.model.cuts": ("BallCut", "BodyCut", "RodCut"),
        "vehicledyn.multibody.equations.derivation": ("derive",),
        "vehicledyn.multibody.elements.drives": ("ConstantRate", "TimeLaw"),
        "vehicledyn.multibody.elements.force_sensors": ("ConstraintForceSensor", "ReactionSensor"),
        "vehicledyn.multibody.elements.point_forces": ("Attachment", "PointForce"),
        "vehicledyn.multibody.model.parts": (
            "BasePart",
            "Loads",
            "DrivenMotion",
            "Output",
            "PartEvent",
            "Wrench",
        ),
        "vehicledyn.multibody.elements.motion_sensors": (
            "Accelerometer",
            "BodySensor",
            "SequenceSensor",
        ),
        "vehicledyn.multibody.model.ground": ("GROUND",),
        "vehicledyn.multibody.model.bodies": ("Body", "Joint", "Turn", "quaternion_joint"),
        "vehicledyn.multibody.model.system": ("System",),
        "vehicledyn.symbolic.parameters": ("ParameterTable",),
    },
)
