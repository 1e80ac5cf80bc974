"""Chains of four-bars of slender rods, with and without springs and dampers at their joints."""

import numpy as np

from vehicledyn.multibody import (
    GROUND,
    BallCut,
    BasePart,
    Body,
    Joint,
    Loads,
    ParameterTable,
    System,
)
from vehicledyn.symbolic.equations import Variable


class Springs(BasePart):
    """Turning springs and dampers on all coordinates [N m/rad, N m s/rad]."""

    def __init__(self, coordinates, stiffness, damping):
        super().__init__("springs")
        self.coordinates, self.stiffness, self.damping = coordinates, stiffness, damping

    def loads(self, situation):
        at = situation.kinematics
        forces = {}
        for name, rest in self.coordinates.items():
            turned = at.coordinate(name) - rest
            forces[name] = -self.stiffness * turned - self.damping * at.rate(name)
        return Loads(joint_forces=forces)


def rod(name, parent, at, angle, **more):
    across = 1.0 / 12.0
    joint = Joint("R2", f"{name}.angle", start=-angle, **more)
    inertia = (0.0, across, across)
    return Body(name, parent, at, (joint,), mass=1.0, com=(0.5, 0.0, 0.0), inertia=inertia)


def chain(count, *, method="multipliers", stiffness=0.0, damping=0.0, last=1.0):
    """Uprights of 1 m and 1 kg, joined by couplers like them; all uprights turn as one.

    With another length ``last`` of the last upright they do not.
    """
    up, tip = 0.5 * np.pi, (1.0, 0.0, 0.0)
    bodies = [rod("upright_0", GROUND, (0.0, 0.0, 0.0), up, start_rate=1.0, role="independent")]
    cuts = []
    for k in range(count):
        bodies.append(rod(f"coupler_{k}", f"upright_{k}", tip, -up))
        bodies.append(rod(f"upright_{k + 1}", GROUND, (k + 1.0, 0.0, 0.0), up))
        cuts.append(
            BallCut(
                f"cut_{k}",
                f"coupler_{k}",
                tip,
                f"upright_{k + 1}",
                (last if k == count - 1 else 1.0, 0.0, 0.0),
            )
        )
    rests = {j.name: float(j.start) for body in bodies for j in body.joints}
    parts = (Springs(rests, stiffness, damping),) if stiffness else ()
    return System(
        f"{count} four-bars", ParameterTable(), tuple(bodies), cuts=tuple(cuts), parts=parts,
        gravity=(0.0, 0.0, -9.81), constraint_method=method,
    )  # fmt: skip


class Follower(BasePart):
    """A state that follows a coordinate in 50 ms and pulls it back, a first-order damper."""

    def states(self):
        return (Variable("place", "rad", "Place of the follower", 0.5),)

    def loads(self, situation):
        q = situation.kinematics.coordinate("bar.angle")
        place = situation.states["place"]
        return Loads(
            joint_forces={"bar.angle": 3.0 * (place - q)}, rates={"place": 20.0 * (q - place)}
        )


def damped_pendulum():
    """A rod with a follower: coordinates and a first-order state without constraints."""
    body = rod("bar", GROUND, (0.0, 0.0, 0.0), -0.5)
    return System(
        "rod", ParameterTable(), (body,), parts=(Follower("follower"),), gravity=(0.0, 0.0, -9.81)
    )
