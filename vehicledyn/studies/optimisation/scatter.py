"""Mean and deviation of figures under scattering parameters, from few runs and their gradients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.polynomial_chaos import gauss_rule
from vehicledyn.analyse.uncertainty import Distribution
from vehicledyn.studies.distributions import read_law
from vehicledyn.studies.known_names import unknown_parameter
from vehicledyn.studies.mistakes import Mistakes

Floats = NDArray[np.float64]

_ROUNDING = 1e-13
"""Part of a figure below which its deviation is rounding."""

_NODES = 3
"""Points of each scattering parameter."""


@dataclass(frozen=True)
class Scatter:
    """Where to run, and how figures there become mean and deviation.

    One parameter after the other stands at the nodes of its Gauss rule, the others at their means:
    exact for figures that are sums of quadratic functions of one normal parameter each, and of
    lines under any law. Rahman, Xu (2004), Probabilistic Engineering Mechanics 19, 393-408.

    ``nodes`` are the parameters' values at each run, the first of them all means; ``rules`` the
    places of the runs and the weights of each parameter.
    """

    laws: dict[str, Distribution] = field(default_factory=dict)
    nodes: tuple[dict[str, float], ...] = ({},)
    rules: tuple[tuple[list[int], Floats], ...] = ()

    @staticmethod
    def of(
        mistakes: Mistakes, given: Mapping[str, Any], units: Mapping[str, str], model: str
    ) -> Scatter:
        """Read the distributions of a study; what is wrong with them is noted."""
        laws = {}
        for full, item in given.items():
            name, place = full.removeprefix("parameters."), ("scatter", full)
            if words := unknown_parameter(name, units, model, role="that can scatter"):
                mistakes.wrong(place, words, at_key=True)
            elif law := read_law(mistakes, place, item, units[name]):
                laws[name] = law
        means = {name: law.mean for name, law in laws.items()}
        nodes, rules = [means], list[tuple[list[int], Floats]]()
        for name, law in laws.items():
            places = []
            values, weights = gauss_rule(law, _NODES)
            for value in values:
                if abs(value - law.mean) < 1e-9 * law.deviation:
                    places.append(0)
                else:
                    places.append(len(nodes))
                    nodes.append(means | {name: float(value)})
            rules.append((places, weights))
        return Scatter(laws, tuple(nodes), tuple(rules))

    def moments(self, values: Floats, slopes: Floats) -> tuple[float, Floats, float, Floats]:
        """Return mean and deviation of a figure, each with its gradient.

        Parameters
        ----------
        values
            The figure at the nodes, shape (k,).
        slopes
            Its gradients there, shape (k, n).
        """
        mean, mean_slope = values[0], slopes[0].copy()
        variance, variance_slope = 0.0, np.zeros(slopes.shape[1])
        for places, weights in self.rules:
            away, leaving = values[places] - values[0], slopes[places] - slopes[0]
            shift, leaning = weights @ away, weights @ leaving
            mean += shift
            mean_slope += leaning
            variance += weights @ (away - shift) ** 2
            variance_slope += 2.0 * (weights * (away - shift)) @ (leaving - leaning)
        deviation = float(np.sqrt(variance))
        if deviation <= _ROUNDING * abs(mean):
            deviation = 0.0
        slope = variance_slope / (2.0 * deviation) if deviation else np.zeros_like(variance_slope)
        return float(mean), mean_slope, deviation, slope

    def moved(self, node: Mapping[str, float], point: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of a run: the scatter of a variable is about its value."""
        changes = dict(node)
        for name, value in point.items():
            law = self.laws.get(name)
            changes[name] = value + (node[name] - law.mean if law else 0.0)
        return changes


def combined(
    scatter: Scatter, runs: Sequence[tuple[Mapping[str, float], Mapping[str, list[float]]]]
) -> dict[str, Any]:
    """Return mean values and slopes of all figures, and their deviations where they scatter."""
    found: dict[str, Any] = {"values": {}, "slopes": {}, "deviations": {}, "deviation_slopes": {}}
    for name in runs[0][0]:
        values = np.array([own[name] for own, _ in runs])
        slopes = np.array([own[name] for _, own in runs])
        mean, slope, deviation, other = scatter.moments(values, slopes)
        found["values"][name], found["slopes"][name] = mean, slope.tolist()
        if scatter.laws:
            found["deviations"][name], found["deviation_slopes"][name] = deviation, other.tolist()
    return found
