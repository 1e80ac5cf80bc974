"""Starts of a system at other values of one of its parameters.

Start coordinates and rates of a file may be calculated from its parameters, as the spin of a
wheel from the speed. The file is read again at each value.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.own_speed import at_value
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.files.scenario.target import Target
from vehicledyn.symbolic.equations import Equations


@dataclass(frozen=True)
class ParameterStarts:
    """Starts of a prepared target along its parameter ``name``."""

    prepared: Prepared
    target: Target
    name: str

    def at(self, value: float) -> Prepared:
        """Return the same system with the starts that its file gives at a value in SI.

        The parameters of its kernel stay as they are. Models without a file have starts that no
        parameter changes.

        Raises
        ------
        InputError
            If the parameter may not have this value.
        """
        written = self.target.written
        if written.file is None or self.name not in written.units:
            return self.prepared
        subject = build_subject(at_value(self.target, self.name, value, written.units[self.name]))
        before = self.prepared
        equations = starting_at(before.equations, before.subject, subject)
        kernel = replace(before.kernel, equations=equations)
        kernel = kernel.with_parameters(before.kernel.parameters)
        return replace(before, subject=subject, equations=equations, kernel=kernel)

    def differ(self, first: float, last: float) -> bool:
        """Return whether the start differs between two values of the parameter."""
        return starts_of(self.at(first).subject) != starts_of(self.at(last).subject)


def starting_at(equations: Equations, before: Subject, subject: Subject) -> Equations:
    """Return equations whose states start where the joints of a subject do.

    Only what differs from the subject the equations were made of, ``before``, is changed.
    """
    old, new = starts_of(before), starts_of(subject)
    changed = {name: value for name, value in new.items() if old.get(name) != value}
    if not changed:
        return equations
    states = tuple(
        replace(s, start=changed[s.name]) if s.name in changed else s for s in equations.states
    )
    unknowns = tuple(
        replace(u, start=changed[u.name]) if u.name in changed else u for u in equations.unknowns
    )
    return replace(equations, states=states, unknowns=unknowns)


def starts_of(subject: Subject) -> dict[str, float]:
    """Return start coordinates [m, rad] and rates of the joints of a subject by name."""
    found = {}
    for joint in subject.system.joints():
        found[joint.name] = float(joint.start)
        found[f"{joint.name}_rate"] = float(joint.start_rate)
    return found
