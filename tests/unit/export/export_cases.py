"""Systems to export, random points of them, and what the kernel and the expressions give there."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module

import casadi as ca
import numpy as np

from vehicledyn.analyses.preparation.build_model import build_vehicle
from vehicledyn.export.procedures import procedures
from vehicledyn.files.scenario import load_model
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    BasePart,
    Body,
    Joint,
    Loads,
    Output,
    ParameterTable,
    System,
    TimeLaw,
)
from vehicledyn.multibody.equations.equation_terms import derive_ingredients
from vehicledyn.multibody.model.constraints import RateConstraint
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.tables import CurveTable

__all__ = ["CASES", "Case", "case"]


def rod(
    table, name, parent, at, *, axis="R2", length=1.0, start=0.5, rate=0.0, role="auto", rotor=0.0
):
    """A uniform rod along its own first axis, with parameters of its own."""
    long = table.add(f"{name}.length", length, "m", f"Length of the {name} rod")
    mass = table.add(f"{name}.mass", 1.3 * length, "kg", f"Mass of the {name} rod")
    across = mass * long * long / 12.0
    joint = Joint(
        axis, f"{name}.angle", start=start, start_rate=rate, role=role, reflected_inertia=rotor
    )
    body = Body(
        name, parent, at, (joint,), mass=mass, com=(0.5 * long, 0.0, 0.0),
        inertia=(0.0, across, across),
    )  # fmt: skip
    return body, long


@dataclass(frozen=True)
class Motor(BasePart):
    """A motor with a state of its own, a stop on one side, and every kind of arithmetic."""

    coordinate: str

    def states(self):
        return (Variable("current", "A", "Current", 0.2),)

    def loads(self, situation):
        rate = situation.kinematics.rate(self.coordinate)
        angle = situation.kinematics.coordinate(self.coordinate)
        current = situation.states["current"]
        beyond = ops.maximum(angle - 0.4, 0.0)
        stop = ops.where(ops.logic_and(beyond > 0.0, rate > -5.0), 3.0 * beyond**1.5, 0.0)
        torque = ops.tanh(current) * 2.0 - stop - 0.1 * ops.absolute(rate) * rate
        change = ops.sin(situation.time) - current * ops.exp(-current * current)
        return Loads(joint_forces={self.coordinate: torque}, rates={"current": change})


def double_pendulum():
    table = ParameterTable()
    upper, length = rod(table, "upper", GROUND, (0.0, 0.0, 0.0))
    lower, _ = rod(table, "lower", "upper", (length, 0.0, 0.0), length=0.7, rate=-1.0)
    return System("double pendulum", table, (upper, lower))


def four_bar():
    table = ParameterTable()
    crank, length = rod(
        table, "crank", GROUND, (0.0, 0.0, 0.0), axis="R3", length=0.4, start=0.8, rate=4.0,
        role="independent", rotor=0.7,
    )  # fmt: skip
    coupler, reach = rod(
        table, "coupler", "crank", (length, 0.0, 0.0), axis="R3", length=1.1, start=-0.6
    )
    rocker, height = rod(table, "rocker", GROUND, (1.0, 0.0, 0.0), axis="R3", length=0.8, start=1.2)
    cut = BallCut("pin", "coupler", (reach, 0.0, 0.0), "rocker", (height, 0.0, 0.0))
    gravity = (0.0, -table.add("gravity", 9.81, "m/s^2", "Gravity"), 0.0)
    return System("four-bar", table, (crank, coupler, rocker), (cut,), gravity=gravity)


def motor_on_a_shaker():
    """An open chain on a shaken base with a motor that has a rotor, a state and a stop."""
    table = ParameterTable()
    height = Joint("T3", "base.height", role="driven", reflected_inertia=0.8)
    base = Body("base", GROUND, (0.0, 0.0, 0.0), (height,), mass=2.0)
    rotor = table.add("rotor", 0.3, "kg*m^2", "Inertia of the rotor behind its gear")
    first, length = rod(table, "first", "base", (0.0, 0.0, 0.0), rotor=rotor)
    second, _ = rod(table, "for", "first", (length, 0.0, 0.0), axis="R3", length=0.6)
    shaker = TimeLaw("shaker", "base.height", lambda t: 0.1 * ops.sin(3.0 * t))
    parts = (shaker, Motor("motor", "first.angle"))
    return System("motor on a shaker", table, (base, first, second), parts=parts)


def skate():
    """A sledge on a knife edge: one rate follows from a non-holonomic constraint."""
    table = ParameterTable()
    mass = table.add("mass", 2.0, "kg", "Mass")
    joints = (
        Joint("T1", "x", start_rate=1.0), Joint("T2", "y"),
        Joint("R3", "yaw", start=0.3, start_rate=0.5),
    )  # fmt: skip
    body = Body("skate", GROUND, (0.0, 0.0, 0.0), joints, mass=mass, com=(0.3, 0.0, 0.0),
                inertia=(0.1, 0.1, 0.2))  # fmt: skip

    def sideways(movement):
        heading = movement.coordinate("yaw")
        return ops.cos(heading) * movement.rate("y") - ops.sin(heading) * movement.rate("x")

    knife = RateConstraint("knife", law=sideways)
    return System("skate", table, (body,), constraints=(knife,))


@dataclass(frozen=True)
class Curves(BasePart):
    """A spring by a cubic curve and a brake by a line; a channel of both, one beyond its end."""

    def loads(self, situation):
        angle = situation.kinematics.coordinate("rod.angle")
        rate = situation.kinematics.rate("rod.angle")
        return Loads(joint_forces={"rod.angle": -SPRING.value(angle) - BRAKE.value(rate)})

    def outputs(self, situation):
        angle = situation.kinematics.coordinate("rod.angle")
        values = {
            "slope": SPRING.slope(angle) * BRAKE.slope(angle),
            "beyond": SPRING.value(angle + 9.0) + SPRING.value(angle - 9.0),
            "chosen": BRAKE.value(angle > 0.0),
        }
        return tuple(Output(Channel(f"c.{n}", "1", n), v) for n, v in values.items())


SPRING = CurveTable.through("spring's force", -1.0, 0.1, np.sinh(np.arange(-1.0, 1.05, 0.1)))
BRAKE = CurveTable("brake", -2.0, 4.0, [[-0.2, 0.4]])


def rod_on_curves():
    table = ParameterTable()
    body, _ = rod(table, "rod", GROUND, (0.0, 0.0, 0.0))
    return System("rod on curves", table, (body,), parts=(Curves("curves"),))


UNARY = (
    *("sin", "cos", "tan", "atan", "sinh", "cosh", "tanh", "asinh", "exp", "fabs", "sign"),
    *("floor", "ceil", "erf", "expm1", "log1p", "asin", "acos", "atanh", "log", "sqrt"),
)
BINARY = ("atan2", "fmin", "fmax", "fmod", "remainder", "copysign", "hypot")


@dataclass(frozen=True)
class Calculator(BasePart):
    """Show every operation there is, of two coordinates and in all ways to nest them."""

    def outputs(self, situation):
        x, y = situation.kinematics.coordinate("a"), situation.kinematics.rate("b")
        inside = 0.5 + 0.4 * ca.sin(x)
        results = {
            **{name: getattr(ca, name)(inside if k > 15 else 3.0 * x) for k, name in
               enumerate(UNARY)},
            **{name: getattr(ca, name)(5.0 * x, y) for name in BINARY},
            "acosh": ca.acosh(1.0 + x * x),
            "power": ca.fabs(x) ** y + inside**2.3,
            "twice": (x + x) / (y + y + 1.0),
            "inverse": 1.0 / (2.0 + x) / (1.0 / (3.0 + y)),
            "nested": x - (y - (x - y)) - x / (y / (x * (y / x))),
            "signs": -(-x - y) * -(x * -y) + (-3.0) ** 3 * (x - -2.0),
            "square": (x + y) ** 2 - (x - y) ** 4,
            "conditions": (x < y) + 3.0 * (y <= x) - -(x >= 0.0) + (x < 9.0) / (y < 9.0),
            "equal": ca.if_else(x == x * 1.0, 2.0, 3.0) + 7.0 * (x != y) + (x == y),
            "logic": ca.logic_or(ca.logic_and(x < y, x > 0.0), ca.logic_not(y > 0.0)) * 1.0,
            "choice": ca.if_else(x < y, ca.if_else(y > 0.1, x, -y), x * y) - 1.0,
            "choice_of_truth": ca.if_else(x > y, x > 0.0, ca.logic_not(x > 0.0)) + x,
            "tiny": x + 1e-300 * y + 1e22 * 1e-22 * y,
        }  # fmt: skip
        return tuple(Output(Channel(f"c.{n}", "1", n), v) for n, v in results.items())


def calculator():
    joints = (Joint("T1", "a", start=0.3), Joint("T2", "b", start=0.2))
    body = Body("mass", GROUND, joints=joints, mass=1.0)
    return System("calculator", ParameterTable(), (body,), parts=(Calculator("calculator"),))


def iltis():
    import_module("vehicledyn.catalogue")
    return build_vehicle(load_model("iltis")).system


CASES = {
    "double_pendulum": double_pendulum,
    "four_bar": four_bar,
    "motor_on_a_shaker": motor_on_a_shaker,
    "skate": skate,
    "rod_on_curves": rod_on_curves,
    "calculator": calculator,
    "iltis": iltis,
}


class Case:
    """A system with its expressions, its kernel and random points at which both are evaluated."""

    def __init__(self, system):
        self.ingredients = g = derive_ingredients(system)
        self.equations = e = g.equations
        self.kernel = compile_kernel(e, backend="interpreted")
        self.procedures = procedures(g)
        self._functions = {
            p.name: [ops.numeric([a.symbols for a in p.arguments], _dense(t)) for t in p.targets]
            for p in self.procedures
        }

    def point(self, seed):
        """Arguments by name; states near the start, unknowns solve the loops."""
        rng, e, g = np.random.default_rng(seed), self.equations, self.ingredients
        n = len(e.positions)
        x = np.array([v.start for v in e.states])
        x[:n] += rng.uniform(-0.02, 0.02, n)
        x[n:] += rng.uniform(-1.0, 1.0, len(x) - n)
        time = rng.uniform(0.0, 1.0)
        values = np.array([p.value for p in e.parameters])
        values *= rng.uniform(0.999, 1.001, len(values))
        self.kernel.set_parameters(values)
        z = self.kernel.solve_unknowns(time, x, [v.start for v in e.unknowns])
        size = len(g.variables)
        return {
            "t": time, "x": x, "z": z, "p": values,
            "q": np.array([v.start for v in g.variables]) + rng.uniform(-0.3, 0.3, size),
            "qd": rng.uniform(-1.0, 1.0, size), "qdd": rng.uniform(-9.0, 9.0, size),
            "s": np.array([v.start for v in g.part_variables]) + rng.uniform(
                -0.1, 0.1, len(g.part_variables)
            ),
            "u": np.array([v.start for v in g.part_unknown_variables]),
        }  # fmt: skip

    def value(self, name, point):
        """Results of a procedure at a point, from CasADi's evaluation of its expressions."""
        procedure = next(p for p in self.procedures if p.name == name)
        arguments = [point[a.name] for a in procedure.arguments]
        return [
            function(*arguments)[:, 0] if len(target.shape) == 1 else function(*arguments)
            for function, target in zip(self._functions[name], procedure.targets, strict=True)
        ]

    def expected(self, point):
        """Results of all procedures at a point; rates, channels and loops from the kernel."""
        self.kernel.set_parameters(point["p"])
        found = {p.name: self.value(p.name, point) for p in self.procedures}
        where = point["t"], point["x"], point["z"]
        found["rates"] = [self.kernel.rates(*where)]
        found["sensors"] = [self.kernel.outputs(*where)]
        found["solve_loops"] = [point["z"]]
        return found


def _dense(target):
    rows, columns = (*target.shape, 1)[:2]
    entries = [
        target.entries.get((i, j)[: len(target.shape)], 0.0)
        for j in range(columns)
        for i in range(rows)
    ]
    return ops.column(entries).reshape((rows, columns))


@cache
def case(name):
    return Case(CASES[name]())
