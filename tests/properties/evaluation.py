"""Numbers of derived equations at a state: rates, outputs by name, directional derivatives."""

from functools import lru_cache

import numpy as np

from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.symbolic import ops


class Derived:
    """Equations of a system with a random state that closes its loops."""

    def __init__(self, system, seed=0):
        self.system = system
        self.equations = e = derive(system)
        self.inputs = [e.time, e.state, e.algebraic, e.parameter]
        self.parameters = np.array([p.value for p in e.parameters])
        self.rng = np.random.default_rng(seed)
        self._output = ops.numeric(self.inputs, e.output)
        self._rate = ops.numeric(self.inputs, e.rate)
        self._residual = ops.numeric(self.inputs, e.residual)
        self._slope = ops.numeric(self.inputs, ops.jacobian(e.residual, e.algebraic))
        self.time = 0.0
        x = np.array([v.start for v in e.states])
        n = len(e.positions)
        x[:n] += self.rng.uniform(-0.02, 0.02, size=n)
        x[n : 2 * n] = self.rng.uniform(-1.0, 1.0, size=n)
        self.point = (0.0, x, self.closed(0.0, x), self.parameters)

    def closed(self, time, x):
        """Unknowns that fulfil the constraints at a state, by Newton's method."""
        z = np.array([v.start for v in self.equations.unknowns])
        for _ in range(30 if z.size else 0):
            gap = self._residual(time, x, z, self.parameters)[:, 0]
            if np.abs(gap).max() < 1e-15:
                break
            z = z - np.linalg.solve(self._slope(time, x, z, self.parameters), gap)
        return z

    @property
    def names(self):
        return [c.name for c in self.equations.channels]

    @property
    def output(self):
        """Outputs at the state by channel."""
        return dict(zip(self.names, self._output(*self.point)[:, 0], strict=True))

    @property
    def rate(self):
        """Rates at the state by state."""
        states = (s.name for s in self.equations.states)
        return dict(zip(states, self._rate(*self.point)[:, 0], strict=True))

    @property
    def coordinates(self):
        """Coordinates, rates and accelerations by joint, from the channels and the rates."""
        names = [j.name for j in self.system.joints() if j.name in self.names]
        values, q, qd, qdd = self.output, {}, {}, {}
        second = self.along(self.expression(*(f"{n}_rate" for n in names)))
        for name, acceleration in zip(names, second, strict=True):
            q[name], qd[name] = values[name], values[f"{name}_rate"]
            qdd[name] = acceleration
        return q, qd, qdd

    def expression(self, *channels):
        """Column of the expressions of some channels."""
        at = {name: k for k, name in enumerate(self.names)}
        return ops.column([self.equations.output[at[name]] for name in channels])

    def derivative(self, expression):
        """Expression of the rate of change along the motion, every path through t, x and z."""
        e = self.equations
        moving = [f"{u.name}_rate" for u in e.unknowns]
        direction = ops.column(
            [ops.scalar(1.0), *self._items(e.rate), *self._items(self.expression(*moving))]
        )
        variables = ops.column([e.time, *self._items(e.state), *self._items(e.algebraic)])
        return ops.derivative(expression, variables, direction)

    def value(self, expression):
        """Numbers of an expression at the state."""
        return ops.numeric(self.inputs, expression)(*self.point)

    def along(self, expression):
        """Rate of change of a column along the motion, at the state."""
        return self.value(self.derivative(expression))[:, 0]

    @staticmethod
    def _items(column):
        return [column[k] for k in range(column.shape[0])]


@lru_cache(maxsize=64)
def derived(make, seed):
    """The equations of a random system at its state, for all tests of one process."""
    return Derived(make(seed), seed)
