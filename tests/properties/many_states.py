"""One derivation, many random states and parameter values: everything as one compiled column."""

import numpy as np
from evaluation import Derived

from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Situation, Wrench
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops

PARAMETERS = 0.02
"""Part by which every parameter is changed at random."""


CLOSED = 1e-13
"""Largest gap of a closed loop [m, rad]."""


class ManyStates(Derived):
    """Equations of a system, evaluated at as many random states as asked for."""

    def __init__(self, system, reach):
        super().__init__(system)
        self.reach = reach
        self.base = self.parameters
        e = self.equations
        self.tree = unfold(system.bodies)
        self.coordinate_names = [j.name for j in system.joints()]
        self.columns = {}
        k = self._closed_kinematics()
        self._collect(k, *self._loads())
        names = list(self.columns)
        self._sizes = [self.columns[n].shape[0] for n in names]
        self._all = ops.numeric(self.inputs, ops.stacked(*self.columns.values()))
        self._names = names
        self._state_count = len(e.states)

    def _closed_kinematics(self):
        """Kinematics whose coordinates, rates and accelerations are expressions of the state."""
        names = self.coordinate_names
        q = self.expression(*names)
        qd = self.expression(*(f"{n}_rate" for n in names))
        qdd = self.derivative(qd)
        self.columns |= {"q": q, "qd": qd, "qdd": qdd}
        return Kinematics(
            self.tree, *({n: c[i] for i, n in enumerate(names)} for c in (q, qd, qdd))
        )

    def _loads(self):
        """Wrenches and joint forces of the parts as expressions of the state."""
        e, names = self.equations, self.coordinate_names
        at = {s.name: e.state[i] for i, s in enumerate(e.states)}
        symbols = [{n: ops.symbol(f"{n}{order}") for n in names} for order in (0, 1)]
        k = Kinematics(self.tree, *symbols)
        old = ops.column([s[n] for s in symbols for n in names])
        new = ops.stacked(self.columns["q"], self.columns["qd"])
        wrenches, forces = [], {}
        for part in self.system.parts:
            own = {v.name: at[f"{part.name}.{v.name}"] for v in part.states()}
            loads = part.loads(Situation(e.time, own, {}, k))
            wrenches += [
                Wrench(w.body, *(ops.substitute(v, old, new) for v in (w.force, w.torque)))
                for w in loads.wrenches
            ]
            for name, force in loads.joint_forces.items():
                here = ops.substitute(ops.scalar(force), old, new)
                forces[name] = forces.get(name, 0.0) + here
        return wrenches, forces

    def _collect(self, k, wrenches, forces):
        e = self.equations
        gravity = ops.vector(*self.system.gravity)
        energy = self.expression("energy.kinetic", "energy.gravity")
        first = self.derivative(e.residual)
        masses = mass_matrix(k, set(self.coordinate_names))
        names = self.coordinate_names
        needed, _ = inverse_dynamics(k, wrenches, gravity)
        linear, angular = self._momentum(k)
        momentum = ops.stacked(linear, angular)
        self.columns |= {
            "output": e.output,
            "power": self.derivative(energy),
            "gap": e.residual,
            "opening": first,
            "bend": self.derivative(first),
            "mass": ops.column([masses.get((a, b), 0.0) for a in names for b in names]),
            "needed": ops.column([needed[n] for n in names]),
            "momentum rate": self.derivative(momentum),
            "outer": self._outer(k, wrenches, gravity),
        }
        for w, wrench in enumerate(wrenches):
            self.columns[f"wrench {w}"] = ops.stacked(wrench.force, wrench.torque)
        self.wrench_bodies = [w.body for w in wrenches]
        self.columns["joint forces"] = ops.column([forces.get(n, 0.0) for n in names])

    def _bodies(self):
        return [body for body in self.system.bodies if body.mass is not None]

    def _momentum(self, k):
        linear = angular = ops.vector(0.0, 0.0, 0.0)
        for body in self._bodies():
            p = body.mass * k.velocity(body.name, body.com)
            spin = inertia.matrix_of(body.inertia) @ k.angular_velocity(body.name)
            linear = linear + p
            angular = angular + k.rotation(body.name) @ spin
            angular = angular + ops.cross(k.position(body.name, body.com), p)
        return linear, angular

    def _outer(self, k, wrenches, gravity):
        """Force and torque about the world's origin of weights and of all wrenches."""
        force = torque = ops.vector(0.0, 0.0, 0.0)
        for body in self._bodies():
            weight = body.mass * gravity
            force = force + weight
            torque = torque + ops.cross(k.position(body.name, body.com), weight)
        for wrench in wrenches:
            own = k.rotation(wrench.body) @ wrench.force
            force = force + own
            torque = torque + k.rotation(wrench.body) @ wrench.torque
            torque = torque + ops.cross(k.position(wrench.body), own)
        return ops.stacked(force, torque)

    def at(self, seed):
        """Everything at a random state, by name; outputs by channel under "channel"."""
        self.go_to(seed)
        column = self._all(*self.point)[:, 0]
        parts = np.split(column, np.cumsum(self._sizes)[:-1])
        found = dict(zip(self._names, parts, strict=True))
        n = len(self.coordinate_names)
        found["mass"] = found["mass"].reshape(n, n)
        found["channel"] = dict(zip(self.names, found["output"], strict=True))
        return found

    def go_to(self, seed):
        """Choose the state and the parameters of a seed, nearer where loops do not close there."""
        for near in 0.3 ** np.arange(6.0):
            self._choose(np.random.default_rng(seed), near)
            if np.abs(self._residual(*self.point)).max(initial=0.0) < CLOSED:
                return
        raise AssertionError(f"the loops of {self.system.name} do not close near their start")

    def _choose(self, rng, near):
        e = self.equations
        changes = rng.uniform(-1.0, 1.0, size=self.base.size)
        self.parameters = self.base * (1.0 + PARAMETERS * near * changes)
        x = np.array([v.start for v in e.states])
        moving = {e.states[k].name for k in e.velocities}
        for k, s in enumerate(e.states):
            spread = 1.0 if s.name in moving else self.reach * near
            x[k] += rng.uniform(-spread, spread)
        time = rng.uniform(0.0, 0.3 * near)
        self.point = (time, x, self.closed(time, x), self.parameters)
