"""What names of a scenario's run mean: its parameters, channels and figures of these."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from vehicledyn.analyse.gradients.key_figures import KINDS, unit_of
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.sensitivity.names import START
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity

Parameters: TypeAlias = Mapping[str, tuple[Quantity, float]]
"""Parameters by name, with their values."""

_FIGURE = re.compile(r"(\w+)\((.+)\)")


@dataclass(frozen=True)
class KnownNames:
    """Parameters and starts of states of a scenario's run, with their values; units of channels.

    Starts of states are named ``start.STATE``.
    """

    model: str
    parameters: Parameters
    starts: Parameters
    channels: Mapping[str, str]

    @staticmethod
    def of(loaded: LoadedScenario, progress: Progress) -> KnownNames:
        """Prepare a scenario, which is remembered for its runs.

        Raises
        ------
        InputError
            If it has no motion.
        NumericalError
            If it has no start.
        """
        prepared, start = prepare_run(loaded, backend="auto", progress=progress)
        equations = prepared.equations
        starts = {
            f"{START}{s.name}": (
                Quantity(f"{START}{s.name}", s.unit, s.description),
                float(value),
            )
            for s, value in zip(equations.states, start.state, strict=True)
        }
        channels = {channel.name: channel.unit for channel in equations.channels}
        return KnownNames(equations.name, parameters_of(prepared), starts, channels)

    def channel_unit(self, channel: str) -> str:
        """Return the unit of a channel.

        Raises
        ------
        InputError
            If there is none of this name.
        """
        if channel not in self.channels:
            guess = nearest_name(channel, self.channels)
            hint = f"; did you mean '{guess}'?" if guess else ""
            raise InputError(f"'{channel}' is no channel of '{self.model}'{hint}")
        return self.channels[channel]

    def figure_units(self, names: Iterable[str]) -> dict[str, str]:
        """Return the units of figures of channels by name; those of others only a run shows."""
        found = {}
        for name in names:
            match = _FIGURE.fullmatch(name)
            if match and match[1] in KINDS and match[2] in self.channels:
                found[name] = unit_of(match[1], self.channels[match[2]])
        return found


def parameters_of(prepared: Prepared) -> dict[str, tuple[Quantity, float]]:
    """Return the parameters of a prepared model with their values."""
    pairs = zip(prepared.equations.parameters, prepared.kernel.parameters, strict=True)
    return {p.name: (Quantity(p.name, p.unit, p.description), float(v)) for p, v in pairs}


def unknown_parameter(name: str, known: Iterable[str], model: str, *, role: str) -> str:
    """Return what is wrong with the name of a parameter, empty if nothing is.

    ``role`` is what the parameter is wanted for, such as ``to vary``.
    """
    names = list(known)
    if name == "speed":
        return f"'speed' is the scenario's, no parameter of '{model}' {role}"
    if name in names:
        return ""
    guess = nearest_name(name, names)
    hint = f"; did you mean '{guess}'?" if guess else ""
    return f"'{name}' is no parameter of '{model}' {role}{hint}"
