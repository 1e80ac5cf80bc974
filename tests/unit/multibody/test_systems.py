"""Systems: the checks of their parts, starts, assembly, partition, drives and sensors."""

import doctest
import subprocess
import sys
from dataclasses import dataclass

import numpy as np
import pytest

import vehicledyn.multibody
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.multibody import (
    GROUND,
    Accelerometer,
    BallCut,
    BasePart,
    Body,
    BodyCut,
    BodySensor,
    ConstantRate,
    DrivenMotion,
    Joint,
    Loads,
    Output,
    ParameterTable,
    RodCut,
    SequenceSensor,
    System,
    TimeLaw,
    Turn,
    derive,
)
from vehicledyn.multibody.elements.motion_sensors import FloorSensor
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel

BALL = (0.1, 0.1, 0.1)


def system(bodies, **more):
    return System("test", ParameterTable(), tuple(bodies), **more)


def mass(name, parent=GROUND, joints=(), **more):
    settings = {"mass": 1.0, "inertia": BALL, **more}
    return Body(name, parent, joints=tuple(joints), **settings)


def values(equations, time=0.0, state=None):
    x = [s.start for s in equations.states] if state is None else state
    z = [u.start for u in equations.unknowns]
    inputs = [equations.time, equations.state, equations.algebraic, equations.parameter]
    p = [v.value for v in equations.parameters]
    found = ops.numeric(inputs, equations.output)(time, x, z, p)[:, 0]
    return dict(zip((c.name for c in equations.channels), found, strict=True))


# -- the package's door --------------------------------------------------------------------


def test_every_public_name_exists():
    for name in vehicledyn.multibody.__all__:
        found = getattr(vehicledyn.multibody, name)
        assert callable(found) or found == GROUND
    with pytest.raises(AttributeError, match="no attribute 'Bodi'"):
        _ = vehicledyn.multibody.Bodi


def test_the_example_of_the_package_runs():
    result = doctest.testmod(vehicledyn.multibody)
    assert result.attempted > 5
    assert result.failed == 0


def test_the_door_loads_neither_casadi_nor_numpy():
    code = "import sys, vehicledyn.multibody; print({'casadi', 'numpy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# -- checks of the tree --------------------------------------------------------------------


def test_all_faults_are_named_at_once():
    bad = system(
        [
            mass("one", joints=[Joint("R4", "a")]),
            mass("one", "chasis", [Joint("R1", "a", role="fixed")]),
            mass("wheel", "one", [Joint("R1", "b")], spins_about=2),
        ],
        cuts=(RodCut("rod", "one", (0, 0, 0), "two", (0, 0, 0), 1.0),),
        parts=(BasePart("rod"),),
    )
    with pytest.raises(InputError) as raised:
        bad.check()
    text = str(raised.value)
    for piece in (
        "8 problem(s)",
        "body 'one' is defined twice",
        "'chasis'",
        "must be R2",
        "'R4'",
        "'fixed'",
        "joint 'a' is defined twice",
        "cut 'rod'",
        "'rod' names two parts",
    ):
        assert piece in text


def test_nothing_hangs_on_axes_that_do_not_spin():
    wheel = mass("wheel", joints=[Joint("R2", "spin")], spins_about=2)
    rider = mass("rider", "wheel", [Joint("R1", "sway")])
    cut = RodCut("rod", GROUND, (0, 0, 0), "wheel", (1, 0, 0), 1.0)
    with pytest.raises(InputError, match=r"(?s)2 problem.*'rider': hangs on.*'rod': hangs on"):
        derive(system([wheel, rider], cuts=(cut,)))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"mass": 0.0}, "mass is 0 kg; it must be positive"),
        ({"mass": -1.0}, "mass is -1 kg"),
        ({"mass": float("nan")}, "mass is nan"),
        ({"inertia": (0.1, -0.1, 0.1)}, "none may be negative"),
        ({"inertia": (1e-9, -1e-9, 1e-9)}, "none may be negative"),
        ({"inertia": (1.0, 1.0, 2.1)}, "triangle inequality"),
        ({"inertia": (1.0, 1.0, 1.0, 0.9, 0.0, 0.0)}, "triangle inequality"),
        ({"inertia": (1.0, float("inf"), 1.0)}, "inertia is not a number"),
        ({"com": (0.0, float("nan"), 0.0)}, "centre of mass is not a number"),
    ],
)
def test_impossible_bodies(more, message):
    with pytest.raises(InputError, match=f"body 'it'.*{message}"):
        derive(system([mass("it", joints=[Joint("R1", "a")], **more)]))


def test_inertia_said_to_be_apparent_may_break_the_triangle_inequality():
    six = {"inertia": (0.066, 0.086, 0.0125), "apparent_inertia": True}
    assert derive(system([mass("it", joints=[Joint("R1", "a")], **six)])).states
    with pytest.raises(InputError, match="none may be negative"):
        six["inertia"] = (0.1, -0.1, 0.1)
        derive(system([mass("it", joints=[Joint("R1", "a")], **six)]))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"com": (0.1, 0.0, 0.0)}, "not on axis 2"),
        ({"inertia": (0.1, 0.1, 0.12)}, "not that of a body of revolution"),
        ({"inertia": (0.1, 0.1, 0.1, 0.01, 0.0, 0.0)}, "not that of a body of revolution"),
    ],
)
def test_bodies_that_cannot_spin_without_their_axes(more, message):
    with pytest.raises(InputError, match=message):
        derive(system([mass("it", joints=[Joint("R2", "a")], spins_about=2, **more)]))


def test_a_disc_and_a_point_mass_are_possible():
    disc = mass("disc", joints=[Joint("R1", "a")], inertia=(1.0, 1.0, 2.0))
    point = mass("point", "disc", [Joint("T1", "b")], inertia=(0.0, 0.0, 0.0))
    assert derive(system([disc, point])).structure["degrees_of_freedom"] == 2


@pytest.mark.parametrize("tilt", [0.0, 0.4])
def test_the_one_moment_of_a_planar_body_will_do(tilt):
    """Other moments of a body that turns about one axis do not matter: 0 or any."""
    c, s = np.cos(tilt), np.sin(tilt)
    one = (2.0 * s * s, 0.0, 2.0 * c * c, 0.0, 2.0 * s * c, 0.0)
    found = []
    for inertia in (one, (2.0, 2.0, 2.0)):
        turn = Turn(rotations.turn(2, -tilt))
        bar = mass("bar", joints=[Joint("R3", "a"), turn], com=(0.3, 0.1, 0.0), inertia=inertia)
        found.append(values(derive(system([bar])), state=[0.2, 3.0])["energy.kinetic"])
    assert found[0] == pytest.approx(found[1], rel=1e-12)
    assert found[0] > 9.0


def test_with_starts_replaces_some_starts():
    one = system([mass("one", joints=[Joint("T1", "x", 1.0), Joint("T2", "y", 2.0)])])
    assert [j.start for j in one.with_starts({"y": 5.0}).joints()] == [1.0, 5.0]
    assert [j.start for j in one.joints()] == [1.0, 2.0]
    with pytest.raises(InputError, match="did you mean"):
        one.with_starts({"yy": 1.0})


def test_with_parts_adds_parts():
    one = system([mass("one", joints=[Joint("T1", "x")])], parts=(BasePart("a"),))
    assert [p.name for p in one.with_parts(BasePart("b")).parts] == ["a", "b"]


# -- loops ---------------------------------------------------------------------------------


def triangle(length=1.0, roles=("auto", "auto"), starts=(0.3, 0.4)):
    """Two bars in a row whose end is tied to a point of the ground by a rod."""
    at = (1.0, 0.0, 0.0)
    one = Body(
        "one", GROUND, joints=(Joint("R3", "a", starts[0], roles[0]),), mass=1.0, inertia=BALL
    )
    two = Body("two", "one", at, (Joint("R3", "b", starts[1], roles[1]),), mass=1.0, inertia=BALL)
    rod = RodCut("rod", GROUND, (2.0, 1.0, 0.0), "two", at, length)
    return system([one, two], cuts=(rod,))


def test_assembly_closes_the_loop_from_a_rough_start():
    equations = derive(triangle())
    assert values(equations)["constraints.position_error"] < 1e-12


def test_independent_coordinates_keep_their_start():
    equations = derive(triangle(roles=("independent", "auto")))
    assert equations.states[0].start == 0.3
    assert equations.structure["dependent"] == ["b"]
    assert values(equations)["constraints.position_error"] < 1e-12


@pytest.mark.parametrize("which", [0, 1])
def test_a_coordinate_may_be_declared_dependent(which):
    roles = ["auto", "auto"]
    roles[which] = "dependent"
    assert derive(triangle(roles=roles)).structure["dependent"] == ["ab"[which]]


def test_a_coordinate_that_no_loop_determines_cannot_be_dependent():
    base = triangle()
    other = mass("other", joints=[Joint("T3", "free", role="dependent")])
    with pytest.raises(InputError, match="do not determine 'free'"):
        derive(system([*base.bodies, other], cuts=base.cuts))


def test_a_loop_that_cannot_close_names_its_cut():
    with pytest.raises(NumericalError, match=r"'rod' by .* m stay open"):
        derive(triangle(length=5.0))


def test_the_choice_needs_a_lever():
    """The rod ends on the axis of the second joint's circle: only the first can close it."""
    one = Body("one", GROUND, joints=(Joint("T1", "slide"),), mass=1.0, inertia=BALL)
    two = Body("two", "one", joints=(Joint("R1", "roll"),), mass=1.0, inertia=BALL)
    rod = RodCut("rod", GROUND, (-1.0, 0.0, 0.0), "two", (0.0, 0.0, 0.0), 1.0)
    assert derive(system([one, two], cuts=(rod,))).structure["dependent"] == ["slide"]


def test_a_doubled_constraint_is_named_redundant_and_its_force_is_not_told():
    base = triangle()
    twin = RodCut("twin", GROUND, (2.0, 1.0, 0.0), "two", (1.0, 0.0, 0.0), 1.0)
    equations = derive(system(base.bodies, cuts=(*base.cuts, twin)))
    assert equations.structure["redundant"] == ["twin"]
    assert equations.structure["degrees_of_freedom"] == 1
    assert equations.structure["undetermined"] == ["rod.axial_force", "twin.axial_force"]
    assert not {"rod.axial_force", "twin.axial_force"} & set(values(equations))


def test_a_stretched_chain_is_singular():
    """Both bars and the rod in one line: the constraint has no first-order effect."""
    at = (1.0, 0.0, 0.0)
    one = Body("one", GROUND, joints=(Joint("R3", "a"),), mass=1.0, inertia=BALL)
    two = Body("two", "one", at, (Joint("R3", "b"),), mass=1.0, inertia=BALL)
    rod = RodCut("rod", GROUND, (1.0, 0.0, 0.0), "two", at, 1.0)
    with pytest.raises(InputError, match="singular"):
        derive(system([one, two], cuts=(rod,)))


def test_separate_loops_are_separate_blocks():
    bodies, cuts = [], []
    for name in ("left", "right"):
        bodies += [
            mass(f"{name}_a", joints=[Joint("R3", f"{name}.a", 0.3)]),
            Body(
                f"{name}_b",
                f"{name}_a",
                (1.0, 0.0, 0.0),
                (Joint("R3", f"{name}.b", 0.4),),
                mass=1.0,
                inertia=BALL,
            ),
        ]
        cuts.append(RodCut(name, GROUND, (2.0, 1.0, 0.0), f"{name}_b", (1.0, 0.0, 0.0), 1.0))
    equations = derive(system(bodies, cuts=tuple(cuts)))
    assert [(b.name, b.start, b.stop) for b in equations.blocks] == [
        ("left", 0, 1),
        ("right", 1, 2),
    ]


def test_a_rod_pulls_with_the_weight_that_hangs_on_it():
    """Cut forces have the signs their channels say."""
    bob = mass("bob", joints=[Joint("T3", "z", -2.0)], mass=3.0)
    rod = RodCut("rod", GROUND, (0.0, 0.0, 0.0), "bob", (0.0, 0.0, 0.0), 2.0)
    ball = BallCut("ball", GROUND, (0.0, 0.0, -2.0), "bob", (0.0, 0.0, 0.0))
    hanging = system([bob], cuts=(rod,))
    assert values(derive(hanging))["rod.axial_force"] == pytest.approx(3.0 * 9.81)
    assert values(derive(system([bob], cuts=(ball,))))["ball.force_z"] == pytest.approx(3.0 * 9.81)


def test_a_body_cut_carries_force_and_torque():
    """A cantilever: the end of a free body is welded to the ground."""
    joints = [Joint(k, k.lower()) for k in ("T1", "T2", "T3", "R1", "R2", "R3")]
    beam = mass("beam", joints=joints, mass=2.0, com=(0.5, 0.0, 0.0))
    equations = derive(
        system([beam], cuts=(BodyCut("weld", GROUND, (0, 0, 0), "beam", (0, 0, 0)),))
    )
    found = values(equations)
    assert equations.structure["degrees_of_freedom"] == 0
    assert found["weld.force_z"] == pytest.approx(2.0 * 9.81)
    assert found["weld.torque_y"] == pytest.approx(-2.0 * 9.81 * 0.5)
    assert found["weld.torque_x"] == pytest.approx(0.0, abs=1e-12)


# -- drives --------------------------------------------------------------------------------


def lift(*parts, role="driven"):
    return system([mass("lift", joints=[Joint("T3", "z", 0.5, role)])], parts=parts)


def test_a_time_law_gives_position_rate_and_force():
    found = values(derive(lift(TimeLaw("law", "z", lambda t: 2.0 + ops.sin(3.0 * t)))), time=0.4)
    assert found["z"] == pytest.approx(2.0 + np.sin(1.2))
    assert found["z_rate"] == pytest.approx(3.0 * np.cos(1.2))
    assert found["z_force"] == pytest.approx(9.81 - 9.0 * np.sin(1.2))


def test_a_constant_rate():
    found = values(derive(lift(ConstantRate("rate", "z", 0.3))), time=2.0)
    assert (found["z"], found["z_rate"], found["z_force"]) == pytest.approx((0.6, 0.3, 9.81))


def test_a_driven_coordinate_without_drive_is_locked():
    equations = derive(lift())
    assert equations.structure["locked"] == ["z"]
    assert "z" not in values(equations)


def test_driving_a_free_coordinate_is_refused():
    with pytest.raises(InputError, match=r"'law' drives 'z', which is not a driven joint"):
        derive(lift(ConstantRate("law", "z", 1.0), role="auto"))


def test_driving_a_coordinate_twice_is_refused():
    with pytest.raises(InputError, match=r"'z' is driven by 'one' and 'two'"):
        derive(lift(ConstantRate("one", "z", 1.0), ConstantRate("two", "z", 1.0)))


@dataclass(frozen=True)
class Push(BasePart):
    loaded: Loads
    moved: tuple = ()
    shown: tuple = ()

    def motions(self, clock):
        return dict(self.moved)

    def loads(self, situation):
        return self.loaded

    def outputs(self, situation):
        return tuple(Output(Channel(n, "1", n), ops.scalar(1.0)) for n in self.shown)


def test_an_acceleration_of_a_free_coordinate_is_refused():
    with pytest.raises(InputError, match=r"'push' drives 'z', which is not a driven joint"):
        derive(lift(Push("push", Loads(accelerations={"z": 1.0})), role="auto"))


def test_a_force_on_an_unknown_coordinate_is_refused():
    with pytest.raises(InputError, match=r"'push' acts on 'zz'"):
        derive(lift(Push("push", Loads(joint_forces={"zz": 1.0})), role="auto"))


def test_a_channel_has_one_owner():
    with pytest.raises(InputError, match=r"two parts give a channel named 'energy\.kinetic'"):
        derive(lift(Push("push", Loads(), shown=("energy.kinetic",)), role="auto"))


def test_a_part_may_drive_with_its_own_law():
    push = Push("push", Loads(accelerations={"z": 4.0}), (("z", DrivenMotion(1.0, 2.0)),))
    found = values(derive(lift(push)))
    assert (found["z"], found["z_rate"], found["z_force"]) == pytest.approx((1.0, 2.0, 13.81))


# -- sensors -------------------------------------------------------------------------------


def test_sensors_look_along_the_heading():
    yaw, pitch, roll = 0.6, 0.2, -0.1
    joints = [
        Joint("T1", "x", start_rate=3.0),
        Joint("T2", "y", start_rate=4.0),
        Joint("T3", "z"),
        Joint("R3", "yaw", yaw),
        Joint("R2", "pitch", pitch),
        Joint("R1", "roll", roll),
    ]
    sensors = (
        BodySensor("body", "it"),
        Accelerometer("point", "it"),
        SequenceSensor("angles", "it", (3, 2, 1)),
    )
    found = values(derive(system([mass("it", joints=joints)], parts=sensors)))
    along = 3.0 * np.cos(yaw) + 4.0 * np.sin(yaw)
    left = 4.0 * np.cos(yaw) - 3.0 * np.sin(yaw)
    assert found["body.forward_speed"] == pytest.approx(along)
    assert found["body.lateral_speed"] == pytest.approx(left)
    assert found["body.sideslip_angle"] == pytest.approx(np.arctan2(left, along), abs=1e-6)
    assert found["body.yaw_rate"] == pytest.approx(0.0, abs=1e-15)
    assert found["point.vertical"] == pytest.approx(-9.81)
    assert found["point.longitudinal"] == pytest.approx(0.0, abs=1e-14)
    angles = [found[f"angles.{n}"] for n in ("yaw", "pitch", "roll")]
    assert angles == pytest.approx([yaw, pitch, roll], abs=1e-14)


def test_a_floor_at_rest_feels_its_slope():
    """A body that cannot fall: the weight along its floor, and what is missing of it upwards."""
    roll, gravity = 0.1, 9.81
    body = mass("it", joints=[Joint("R1", "roll", role="driven")])
    parts = (FloorSensor("floor", "it"), ConstantRate("drive", "roll", 0.05))
    found = values(derive(system([body], parts=parts)), time=roll / 0.05)
    assert found["floor.lateral"] == pytest.approx(gravity * np.sin(roll), rel=1e-12)
    assert found["floor.vertical"] == pytest.approx(gravity * (np.cos(roll) - 1.0), rel=1e-9)
    assert found["floor.roll_rate"] == pytest.approx(0.05, rel=1e-12)


def test_an_accelerometer_feels_the_way_to_the_centre():
    joint = Joint("R3", "yaw", start_rate=2.0)
    sensor = Accelerometer("point", "it", (0.0, 0.5, 0.0))
    found = values(derive(system([mass("it", joints=[joint])], parts=(sensor,))))
    assert found["point.lateral"] == pytest.approx(-0.5 * 4.0)
    assert found["point.longitudinal"] == pytest.approx(0.0, abs=1e-14)
