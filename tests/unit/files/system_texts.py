"""Helpers: systems from YAML text, and their channels at any state."""

import numpy as np

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.base.errors import InputError
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive


def load(folder, text, **given):
    """Return the model of a system file with this text; fail with its problems."""
    path = folder / "system.yaml"
    path.write_text(text, encoding="utf-8")
    model, problems = read_system(path, given)
    if problems:
        raise InputError("\n".join(map(str, problems)))
    return model


def problems(folder, text):
    """Return what is wrong with a system file as line:column: field: message."""
    path = folder / "system.yaml"
    path.write_text(text, encoding="utf-8")
    _, found = read_system(path)
    return [str(problem).removeprefix(f"{path}:") for problem in found]


def equations(folder, text, **given):
    """Return the equations of a system file."""
    return derive(build_system(load(folder, text, **given)))


class Motion:
    """Channels and rates of equations at a state that is given by name, others at start."""

    def __init__(self, equations):
        self.equations = equations
        self.kernel = compile_kernel(equations, backend="interpreted")

    def at(self, time=0.0, **states):
        """Return all channels and, as ``d.name``, the rates of the states."""
        e = self.equations
        named = {key.replace("__", "."): value for key, value in states.items()}
        assert set(named) <= {s.name for s in e.states}, [s.name for s in e.states]
        x = np.array([named.get(s.name, s.start) for s in e.states])
        z = assemble(self.kernel, time, x, np.array([u.start for u in e.unknowns]))
        rates = self.kernel.rates(time, x, z)
        outputs = self.kernel.outputs(time, x, z)
        found = dict(zip((c.name for c in e.channels), outputs, strict=True))
        found.update({f"d.{s.name}": r for s, r in zip(e.states, rates, strict=True)})
        return found
