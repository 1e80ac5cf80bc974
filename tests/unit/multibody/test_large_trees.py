"""Large trees: inertia that joints feel, choice of pivots, and kernels that are not worked over."""

from dataclasses import replace

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.passes.plain_functions import plain_functions
from vehicledyn.kernel import compilation_worth as worth
from vehicledyn.kernel.interpreted import InterpretedEngine
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.equations import singular_mass
from vehicledyn.multibody.equations.derivation import solve_motion
from vehicledyn.multibody.equations.effective_inertia import smallest_share
from vehicledyn.multibody.loops.partition import RANK_TOLERANCE, best_pairs
from vehicledyn.multibody.recursion import forward_dynamics as forward

KINDS = ("R1", "T2", "R3", "T1", "R2")


def many(count, parent, *, last_mass=1.0, last_kind="R1", reflected=0.0):
    """Bodies with numbers of their own on joints of all kinds, one of them driven.

    The ``reflected`` inertia is that of the last joint, every other one before has its amount.
    """
    rng = np.random.default_rng(count)
    bodies = []
    for k in range(count):
        below, is_last = parent(k), k == count - 1
        joint = Joint(
            last_kind if is_last else KINDS[k % len(KINDS)],
            f"b{k}.q",
            start=rng.uniform(-1.0, 1.0),
            role="driven" if k == 3 else "auto",
            reflected_inertia=reflected if is_last else (k % 2) * abs(reflected),
        )
        inertia = (*rng.uniform(0.1, 0.15, 3), 0.0, 0.0, 0.0)
        mass, com = rng.uniform(1.0, 2.0), tuple(rng.uniform(-0.1, 0.1, 3))
        if is_last:
            mass, inertia = mass * last_mass, tuple(last_mass * item for item in inertia)
        at = (0.3, 0.0, 0.1) if k else (0.0, 0.0, 0.0)
        place = GROUND if below < 0 else f"b{below}"
        body = Body(f"b{k}", place, at, (joint,), mass=mass, com=com, inertia=inertia)
        bodies.append(body if mass else Body(f"b{k}", place, at, (joint,)))
    return System("many", ParameterTable(), tuple(bodies))


def chain(k):
    return k - 1


def fan(k):
    return (k - 1) // 2


@pytest.mark.parametrize("parent", [chain, fan])
@pytest.mark.parametrize(("last_mass", "own"), [(1.0, 0.0), (1e-10, 0.0), (1.0, 0.4), (0.0, 0.4)])
def test_inertia_felt_is_the_diagonal_of_a_factorisation(parent, last_mass, own):
    """Of the columns by which rates move the masses, leaves first, to rounding of their roots."""
    system = many(12, parent, last_mass=last_mass, reflected=own)
    resistance = solve_motion(system).resistance
    q = np.array([joint.start for joint in resistance.joints])
    columns = resistance._inertial(0.0, q, resistance._values)[:, resistance._free]
    sizes = np.linalg.norm(columns, axis=0)
    diagonal = np.abs(np.diag(np.linalg.qr(columns[:, ::-1], mode="r")))[::-1]
    found = smallest_share(*resistance._link_numbers(0.0, q, resistance._values))
    assert found == pytest.approx((diagonal / sizes).min(), rel=1e-9)


def test_a_joint_without_inertia_is_named_in_a_large_tree(monkeypatch):
    monkeypatch.setattr(singular_mass, "_DENSE", 5)
    derive(many(12, chain))
    with pytest.raises(InputError, match=r"nothing resists 'b11\.q' of body 'b11'"):
        derive(many(12, chain, last_mass=0.0))
    derive(many(12, chain, last_mass=0.0, reflected=1e-3))


def test_a_negative_mass_matrix_of_a_large_tree_is_refused(monkeypatch):
    monkeypatch.setattr(singular_mass, "_DENSE", 5)
    derive(many(12, chain, reflected=-0.05))
    told = r"not positive definite: negative reflected inertias outweigh what 'b11\.q' of body"
    with pytest.raises(InputError, match=told):
        derive(many(12, chain, reflected=-0.2))


def test_what_is_dense_is_not_compared_in_a_large_tree(monkeypatch):
    monkeypatch.setattr(singular_mass, "_DENSE", 5)

    def refused(*_):
        raise AssertionError("the cube of the number of joints")

    monkeypatch.setattr(singular_mass.Resistance, "_inertial", refused)
    derive(many(12, chain))


@pytest.mark.parametrize("parent", [chain, fan])
def test_numbers_given_to_steps_give_the_same_accelerations(parent, monkeypatch):
    """As the factorised mass matrix, with as many functions as there are kinds of joints."""
    system = many(14, parent)
    monkeypatch.setattr(forward, "_LARGE", 1000)
    one = compile_kernel(derive(system, formulation="composite"), backend="interpreted")
    monkeypatch.setattr(forward, "_LARGE", 10)
    two = compile_kernel(derive(system), backend="interpreted")
    state = np.random.default_rng(5).uniform(-1.0, 1.0, len(one.equations.states))
    expected, found = (kernel.rates(0.0, state, []) for kernel in (one, two))
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10)


def test_plain_functions_give_the_same_values():
    equations = derive(many(6, fan))
    state = np.random.default_rng(5).uniform(-1.0, 1.0, len(equations.states))
    none = np.zeros(0)
    ways = [
        InterpretedEngine(equations, make(equations))
        for make in (derive_functions, plain_functions)
    ]
    for name in ("rates", "outputs"):
        one, two = (getattr(way, name)(0.1, state, none, way.prepare(none)) for way in ways)
        assert two == pytest.approx(one, rel=1e-12, abs=1e-12)
    with pytest.raises(ValueError, match="parameters"):
        plain_functions(replace(equations, parameters=(None,)))


def test_large_models_are_compiled_where_that_pays(monkeypatch, needs_compiler):
    equations = derive(many(4, chain))
    monkeypatch.setattr(worth, "LARGE", 10)
    assert compile_kernel(equations).backend == "interpreted"
    assert compile_kernel(equations, evaluations=worth.MANY - 1).backend == "interpreted"
    assert compile_kernel(equations, evaluations=worth.MANY).backend == "compiled"
    assert compile_kernel(equations, backend="compiled").backend == "compiled"
    monkeypatch.setattr(worth, "LARGE", 10_000)
    assert compile_kernel(equations).backend == "compiled"


def pairs_one_by_one(jacobian, columns):
    """Return pivots of Gaussian elimination with full pivoting, as the textbook has it."""
    work, rows, columns, found = jacobian.copy(), list(range(len(jacobian))), list(columns), []
    scale = max(1.0, np.abs(jacobian).max())
    while rows and columns:
        block = np.abs(work[np.ix_(rows, columns)])
        i, j = divmod(int(np.flatnonzero(block >= block.max() * (1.0 - 1e-6))[0]), len(columns))
        if block[i, j] <= RANK_TOLERANCE * scale:
            break
        row, column = rows.pop(i), columns.pop(j)
        found.append((row, column))
        for other in rows:
            work[other] -= work[row] * (work[other, column] / work[row, column])
    return found


@pytest.mark.parametrize("seed", range(8))
def test_pivots_are_those_of_full_pivoting(seed):
    """With entries of equal size, dependent rows and columns that may not be chosen."""
    rng = np.random.default_rng(seed)
    jacobian = rng.integers(-2, 3, (9, 14)).astype(float) * (rng.uniform(size=(9, 14)) < 0.4)
    jacobian[7] = jacobian[2] - 2.0 * jacobian[4]
    may = [int(k) for k in rng.permutation(14)[:11]]
    assert best_pairs(jacobian, may, holonomic=9) == pairs_one_by_one(jacobian, may)
