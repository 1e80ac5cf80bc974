"""Systems built in Python that no motion belongs to: what is wrong, and in which parts."""

import logging
from dataclasses import replace

import numpy as np
import pytest

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    Body,
    Joint,
    ParameterTable,
    RodCut,
    System,
    TimeLaw,
    UserConstraint,
    derive,
)
from vehicledyn.multibody.equations.derivation import solve_motion
from vehicledyn.multibody.model.bodies import quaternion_joint
from vehicledyn.symbolic.elimination import solve_symmetric

BALL = (0.1, 0.1, 0.1)
SOLID = {"mass": 1.0, "com": (0.1, 0.0, 0.0), "inertia": (0.1, 0.2, 0.3)}


def system(*bodies, **more):
    return System("test", ParameterTable(), tuple(bodies), **more)


def arm(
    name, parent=GROUND, kind="R2", at=(0.0, 0.0, 0.0), start=0.0, role="auto", own=0.0, **more
):
    joint = Joint(kind, f"{name}.q", start, role, reflected_inertia=own)
    return Body(name, parent, at, (joint,), **(SOLID | more))


def four_bar(*, crank=0.3, coupler=0.9, roles=("auto",) * 3, cuts=(), **more):
    starts = (-1.05, 0.61, -1.40)
    places = (0.0, crank, 0.8)
    parents = (GROUND, "crank", GROUND)
    bodies = [
        arm(n, p, at=(x, 0.0, 0.0), start=q, role=r)
        for n, p, x, q, r in zip(
            ("crank", "coupler", "rocker"), parents, places, starts, roles, strict=True
        )
    ]
    pin = BallCut("pin", "coupler", (coupler, 0.0, 0.0), "rocker", (0.7, 0.0, 0.0))
    return system(*bodies, cuts=(pin, *cuts), **more)


def refusal(wrong):
    with pytest.raises((InputError, NumericalError)) as refused:
        derive(wrong)
    return refused.value


MASSLESS = {"mass": None, "com": (0.0, 0.0, 0.0), "inertia": (0.0,) * 6}
POINT = {"mass": 1.0, "inertia": (0.0,) * 6}


@pytest.mark.parametrize(
    ("bodies", "idle"),
    [
        ([arm("a"), arm("b", "a", **MASSLESS)], "'b.q' of body 'b'"),
        ([arm("a", **MASSLESS)], "'a.q' of body 'a'"),
        ([arm("a"), arm("b", "a", com=(0.0, 0.3, 0.0), **POINT)], "'b.q' of body 'b'"),
        ([arm("a", kind="T1", **MASSLESS), arm("b", "a", "T1")],
         "'a.q' and 'b.q' of bodies 'a' and 'b' moving together"),
        ([arm("a"), arm("b", "a", "T3"), arm("c", GROUND, "R1", com=(1.0, 0.0, 0.0), **POINT)],
         "'c.q' of body 'c'"),
        ([Body("a", GROUND, joints=tuple(Joint(f"R{k}", f"r{k}", 0.3) for k in (3, 2, 1)),
               mass=1.0, com=(0.0, 0.0, -1.0))], "'r3', 'r2' and 'r1' of body 'a'"),
    ],
)  # fmt: skip
def test_motions_that_no_inertia_resists_are_named(bodies, idle):
    error = refusal(system(*bodies))
    assert isinstance(error, InputError)
    assert f"the mass matrix is singular: nothing resists {idle}" in str(error)
    assert set(error.about) >= {name for name in idle.split("'") if "." in name}


def test_all_motions_without_inertia_come_at_once():
    error = refusal(system(arm("a", **MASSLESS), arm("b", "a"), arm("c", **MASSLESS), arm("d")))
    assert "nothing resists 'a.q' and 'b.q'" in str(error)
    assert "nothing resists 'c.q' of body 'c'" in str(error)


@pytest.mark.parametrize(
    "bodies",
    [
        [arm("a", **MASSLESS), arm("b", "a", "R1")],
        [arm("a", role="driven", **MASSLESS)],
        [arm("a"), arm("b", "a", own=1e-3, **MASSLESS)],
        [arm("a"), arm("b", "a", own=-0.1)],
        [arm("a", mass=1e5), arm("b", "a", "R1", mass=1e-6, inertia=(1e-9,) * 3)],
        [Body("a", GROUND, joints=tuple(Joint(f"R{k}", f"r{k}") for k in (3, 2, 1)), mass=1.0,
              inertia=BALL)],
    ],
)  # fmt: skip
def test_small_or_borrowed_inertia_is_enough(bodies):
    derive(system(*bodies))


def test_motions_with_a_negative_kinetic_energy_are_named():
    """Of a turn beside another, which leaves less than the moment about the hinge, and of loops."""
    error = refusal(system(arm("a"), arm("b", "a", own=-0.11)))
    told = "the mass matrix is not positive definite: negative reflected inertias outweigh what "
    assert isinstance(error, InputError) and f"{told}'a.q' and 'b.q' of bodies" in str(error)
    assert "lower the amounts of the negative reflected inertias" in str(error)
    bar = four_bar()
    bodies = [replace(body, joints=(replace(body.joints[0], reflected_inertia=-0.4),))
              for body in bar.bodies]  # fmt: skip
    assert told in str(refusal(system(*bodies, cuts=bar.cuts)))


@pytest.mark.parametrize(
    ("joint", "told"),
    [
        (Joint("R2", "a.q", reflected_inertia=np.inf), "reflected inertia is inf; give a finite"),
        (replace(quaternion_joint("a")[0], reflected_inertia=1.0), "needs a joint with one"),
    ],
)
def test_reflected_inertias_that_mean_nothing(joint, told):
    assert told in str(refusal(system(Body("a", GROUND, joints=(joint,), **SOLID))))


def test_a_place_where_the_mass_matrix_is_singular_is_no_singular_system():
    """Three turns whose outer axes meet at the start: told where a run starts, not before."""
    turns = tuple(Joint(kind, name) for kind, name in (("R3", "a"), ("R2", "b"), ("R3", "c")))
    found = solve_motion(system(Body("top", GROUND, joints=turns, mass=1.0, inertia=BALL)))
    (idle,) = found.resistance.idle(0.0, np.zeros(3))
    assert idle.shares.keys() == {"a", "c"}
    assert idle.shares["a"] == pytest.approx(-idle.shares["c"], rel=1e-12)
    assert found.resistance.idle(0.0, np.array([0.0, 1e-3, 0.0])) == []
    assert found.resistance.idle(0.0, np.array([0.0, 1e-3, 0.0]), share=1e-2) != []


def test_loops_lend_inertia_and_do_not_invent_it():
    """A massless coupler is carried by the bars beside it; three massless bars are not."""
    light = four_bar()
    bodies = list(light.bodies)
    bodies[1] = arm("coupler", "crank", at=(0.3, 0.0, 0.0), start=0.61, **MASSLESS)
    derive(system(*bodies, cuts=light.cuts))
    none = [arm(b.name, b.parent, at=b.at, start=b.joints[0].start, **MASSLESS) for b in bodies]
    assert "the mass matrix is singular" in str(refusal(system(*none, cuts=light.cuts)))


def test_an_elimination_without_pivot_is_an_input_error():
    with pytest.raises(InputError, match="nothing determines its unknown 1"):
        solve_symmetric([{0: 1.0}, {}], [1.0, 1.0])


def test_lengths_that_do_not_reach_are_no_contradiction():
    error = refusal(four_bar(crank=0.01, coupler=0.02))
    assert isinstance(error, NumericalError)
    assert "'pin' by" in str(error) and error.about == ("pin",)


def test_two_cuts_at_odds_contradict_each_other():
    second = BallCut("pin_2", "coupler", (0.9, 0.0, 0.0), "rocker", (0.75, 0.0, 0.0))
    error = refusal(four_bar(cuts=(second,)))
    assert isinstance(error, InputError)
    assert "'pin_2' by" in str(error) and "'pin' by" in str(error)
    assert "of 4 conditions only 3 can hold at once" in str(error)


def test_constraints_at_odds_tell_by_how_much():
    one, two = (
        UserConstraint(n, lambda g, v=v: g.coordinate("a.q") - v)
        for n, v in (("one", 1.0), ("two", 2.0))
    )
    error = refusal(system(arm("a"), constraints=(one, two)))
    assert "contradictory constraints: 'one' by 0.5 and 'two' by 0.5" in str(error)


def test_a_constraint_that_nothing_can_fulfil():
    apart = BallCut("pin", "a", (0.0, 0.2, 0.0), GROUND, (0.0, 0.0, 0.0))
    error = refusal(system(arm("a"), cuts=(apart,)))
    assert "'pin' by 0.2 m stay open, and no coordinate can change that" in str(error)


@pytest.mark.parametrize(
    ("role", "parts", "words"),
    [
        ("driven", tuple(TimeLaw(f"d_{n}", f"{n}.q", lambda t: t) for n in ("crank", "rocker")),
         "'crank.q' and 'rocker.q' are driven"),
        ("independent", (), "'crank.q' and 'rocker.q' are declared independent"),
    ],
)  # fmt: skip
def test_what_is_held_contradicts_a_loop(role, parts, words):
    error = refusal(four_bar(roles=(role, "auto", role), parts=parts))
    assert isinstance(error, InputError)
    assert "contradictory constraints: 'pin' by" in str(error) and words in str(error)


def test_a_loop_without_freedom_is_told(caplog):
    rod = RodCut("rod", GROUND, (0.0, 0.0, 0.5), "coupler", (0.3, 0.0, 0.0), 0.5)
    with caplog.at_level(logging.WARNING):
        found = derive(four_bar(cuts=(rod,))).structure["rigid_loops"]
    assert found == [
        {"constraints": ["pin", "rod"], "coordinates": ["crank.q", "coupler.q", "rocker.q"]}
    ]
    assert "the loop of 'pin' and 'rod' has no freedom" in caplog.text


@pytest.mark.parametrize("roles", [("auto",) * 3, ("driven", "auto", "auto")])
def test_a_loop_that_is_only_held_has_freedom(roles, caplog):
    parts = () if roles[0] == "auto" else (TimeLaw("d", "crank.q", lambda t: t - 1.05),)
    assert derive(four_bar(roles=roles, parts=parts)).structure["rigid_loops"] == []
    follow = UserConstraint("follow", lambda g: g.coordinate("crank.q") + 1.05 - g.time)
    if not parts:
        moved = derive(four_bar(constraints=(follow,)))
        assert moved.structure["rigid_loops"] == []
    assert caplog.text == ""


def test_parents_that_are_missing_late_or_in_a_circle():
    bodies = [arm("a", "b"), arm("b", "a"), arm("c", "c"), arm("d", "e"), arm("e"), arm("f", "x")]
    text = str(refusal(system(*bodies)))
    assert "body 'a': parent: the bodies hang on each other: a -> b -> a" in text
    assert "body 'c': parent: the bodies hang on each other: c -> c" in text
    assert "body 'd': parent: 'e' is defined after it; put parents first" in text
    assert "body 'f': parent: no body defined before it named 'x'" in text
    assert "4 problem(s)" in text
