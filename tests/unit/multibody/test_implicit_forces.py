"""Loads that depend on the force of a constraint: solved with the accelerations, exactly."""

import math
from dataclasses import dataclass

import pytest

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.analyse.linearise import linearise
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BasePart,
    Body,
    Joint,
    Loads,
    ParameterTable,
    System,
    UserConstraint,
    derive,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable

START, FRICTION, MASS, GRAVITY = 0.5, 0.3, 2.0, 9.81


@dataclass(frozen=True)
class LevelForce(BasePart):
    """A level force μ N downhill on a block, N its normal force on the ground z = -x²/2."""

    channel: str = "multiplier"

    def reactions(self):
        return (Variable("normal_force", "N", "Normal force"),)

    def found_reactions(self, situation):
        steepness = situation.kinematics.coordinate("x")
        vertical = situation.forces.multiplier("ground", self.channel)
        return (vertical * ops.sqrt(1.0 + steepness * steepness),)

    def loads(self, situation):
        return Loads(joint_forces={"x": FRICTION * situation.reactions["normal_force"]})


def block_on_parabola(*parts, more=()):
    joints = (Joint("T1", "x", START, "independent"), Joint("T3", "z", role="dependent"))
    block = Body("block", GROUND, joints=joints, mass=MASS)
    return System(
        "block",
        ParameterTable(),
        (block,),
        parts=parts,
        constraints=(UserConstraint("ground", ground), *more),
    )


def ground(geometry):
    return geometry.coordinate("z") + 0.5 * geometry.coordinate("x") ** 2


def solved(system):
    equations = derive(system)
    kernel = compile_kernel(equations, backend="interpreted")
    state = [variable.start for variable in equations.states]
    guess = [variable.start for variable in equations.unknowns]
    return equations, kernel, state, assemble(kernel, 0.0, state, guess)


def normal_force(x):
    """N of a block at rest, from the balance along the normal: N (1 + μ sin α) = m g cos α."""
    angle = math.atan(x)
    return MASS * GRAVITY * math.cos(angle) / (1.0 + FRICTION * math.sin(angle))


def acceleration(x):
    """ẍ of a block at rest, from the level forces."""
    return normal_force(x) * (math.sin(math.atan(x)) + FRICTION) / MASS


def test_a_force_that_presses_on_its_own_constraint():
    equations, kernel, state, unknowns = solved(block_on_parabola(LevelForce("level")))
    index = [variable.name for variable in equations.unknowns].index("level.normal_force")
    assert unknowns[index] * MASS * GRAVITY == pytest.approx(normal_force(START), rel=1e-12)
    assert kernel.rates(0.0, state, unknowns)[1] == pytest.approx(acceleration(START), rel=1e-12)


def test_implicit_forces_are_the_last_block():
    equations, *_ = solved(block_on_parabola(LevelForce("level")))
    block = equations.blocks[-1]
    assert (block.name, block.start, block.stop, block.kind) == ("level", 1, 2, "force")
    assert equations.unknowns[-1].unit == "1"


def test_linearisation_follows_the_implicit_force():
    equations, _, state, unknowns = solved(block_on_parabola(LevelForce("level")))
    matrix = linearise(equations, [], 0.0, state, unknowns).matrix
    step = 1e-5
    slope = (acceleration(START + step) - acceleration(START - step)) / (2.0 * step)
    assert matrix[1, 0] == pytest.approx(slope, rel=1e-8)


def test_unknown_and_shared_forces_are_refused():
    with pytest.raises(InputError, match=r"'ground\.multiplyer'; did you mean"):
        derive(block_on_parabola(LevelForce("level", "multiplyer")))
    again = UserConstraint("again", lambda geometry: 2.0 * ground(geometry))
    with pytest.raises(InputError, match=r"'ground\.multiplier' is not unique"):
        derive(block_on_parabola(LevelForce("level"), more=(again,)))
