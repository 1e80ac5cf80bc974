"""Cycles found as motions that return, by compiled code."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cycle_examples import cornered_circles, field, sampled_orbit

from vehicledyn.analyse.periodic import autonomous
from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.single_shooting import returning


def test_a_motion_that_multiplies_the_errors_of_its_steps_is_followed_more_finely(
    needs_compiler, monkeypatch
):
    """Contacts make the end of a motion err by thousands of times the error of its steps."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    rng, exact, asked = np.random.default_rng(3), AutonomousField.followed, []

    def upset(self, state, value, durations, **options):
        path = exact(self, state, value, durations, **options)
        if durations.sum() < 0.5 * math.pi:
            return path
        asked.append(options["tolerance"])
        nodes, ends = path.nodes.copy(), np.cumsum(path.steps)
        errors = 2000.0 * options["tolerance"] * options["scales"]
        nodes[ends] += errors * rng.uniform(-1.0, 1.0, (len(ends), len(errors)))
        return replace(path, nodes=nodes)

    monkeypatch.setattr(AutonomousField, "followed", upset)
    model, r = field(cornered_circles(1.0), "mu"), 0.5
    guess = sampled_orbit(
        math.pi, r,
        lambda s: r * np.column_stack([1.01 * np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)]),
    )  # fmt: skip
    found = returning(model, guess, None)
    radii = np.hypot(*found.passages.orbit.states.T)
    assert radii == pytest.approx(r, rel=1e-5)
    assert min(asked) < 1e-9 < max(asked)
