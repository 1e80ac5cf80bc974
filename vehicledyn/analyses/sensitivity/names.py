"""What derivatives are asked of and by: names of figures, channels, parameters, start values."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import KINDS
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.symbolic.equations import Equations

_FIGURE = re.compile(r"(\w+)\((.+)\)")
_PARAMETERS, START = "parameters.", "start."


@dataclass(frozen=True)
class Directions:
    """What derivatives are by: parameters and start values of states.

    ``by_parameter`` (n_parameters, n) and ``by_state`` (n_states, n) hold one column each.
    """

    quantities: tuple[Quantity, ...]
    values: NDArray[np.float64]
    by_parameter: NDArray[np.float64]
    by_state: NDArray[np.float64]


@dataclass
class RequestedNames:
    """What derivatives are of: channels as curves, figures of channels, figures of the run."""

    curves: list[str] = field(default_factory=list)
    figures: list[tuple[str, str]] = field(default_factory=list)
    """Kind and channel."""
    others: list[str] = field(default_factory=list)


def matching(names: Sequence[str], to: Sequence[str], model: str) -> list[int]:
    """Return the numbers of the parameters that patterns name, with or without ``parameters.``.

    Raises
    ------
    InputError
        If a pattern matches none.
    """
    chosen: list[int] = []
    for pattern in to:
        own = pattern.removeprefix(_PARAMETERS)
        found = [k for k, name in enumerate(names) if fnmatchcase(name, own)]
        if not found:
            guess = nearest_name(own, names)
            hint = f"; did you mean '{guess}'?" if guess else ""
            words = f"'{pattern}' matches no parameter of '{model}'{hint}"
            raise InputError(words, argument="to")
        chosen += [k for k in found if k not in chosen]
    return chosen


def directions(
    equations: Equations, values: NDArray[np.float64], state: NDArray[np.float64], to: Sequence[str]
) -> Directions:
    """Return the directions that patterns such as ``parameters.front.*`` or ``start.x`` name.

    Parameters
    ----------
    equations
        The model.
    values, state
        All parameters and the states at the start.
    to
        Patterns; without a first word parameters are meant.

    Raises
    ------
    InputError
        If a pattern matches nothing.
    """
    parameters = [p.name for p in equations.parameters]
    states = [s.name for s in equations.states]
    chosen: list[tuple[bool, int]] = []
    for pattern in to:
        is_state = pattern.startswith(START)
        names = states if is_state else parameters
        own = pattern.removeprefix(START if is_state else _PARAMETERS)
        found = [k for k, name in enumerate(names) if fnmatchcase(name, own)]
        if not found:
            guess = nearest_name(own, names)
            hint = f"; did you mean '{guess}'?" if guess else ""
            what = "start value" if is_state else "parameter"
            words = f"'{pattern}' matches no {what} of '{equations.name}'{hint}"
            raise InputError(words, argument="to")
        chosen += [(is_state, k) for k in found if (is_state, k) not in chosen]
    by_parameter = np.zeros((len(parameters), len(chosen)))
    by_state = np.zeros((len(states), len(chosen)))
    quantities, sizes = [], np.zeros(len(chosen))
    for column, (is_state, k) in enumerate(chosen):
        item = equations.states[k] if is_state else equations.parameters[k]
        name = f"{START}{item.name}" if is_state else item.name
        quantities.append(Quantity(name, item.unit, item.description))
        (by_state if is_state else by_parameter)[k, column] = 1.0
        sizes[column] = (state if is_state else values)[k]
    return Directions(tuple(quantities), sizes, by_parameter, by_state)


def named_channels(of: Sequence[str]) -> list[str]:
    """Return the channels in names such as ``max(chassis.roll)``, unchecked."""
    return [match[2] for name in of if (match := _FIGURE.fullmatch(name))]


def wanted(equations: Equations, of: Sequence[str], known: Sequence[str]) -> RequestedNames:
    """Return what names ask for: channels, ``max(CHANNEL)`` and the like, figures of the run.

    Parameters
    ----------
    equations
        The model.
    of
        Names; patterns may stand for channels and figures.
    known
        Names of the figures of the run.

    Raises
    ------
    InputError
        If a name means nothing; the nearest one is suggested.
    """
    channels = [c.name for c in equations.channels]
    found = RequestedNames()
    for name in of:
        match = _FIGURE.fullmatch(name)
        if match and match[1] in KINDS and match[2] in channels:
            found.figures.append((match[1], match[2]))
            continue
        curves = [item for item in channels if fnmatchcase(item, name)]
        others = [item for item in known if fnmatchcase(item, name)]
        if not curves and not others:
            asked = match[2] if match else name
            guess = nearest_name(asked, [*known, *channels])
            hint = f"; did you mean '{guess}'?" if guess else "."
            kinds = ", ".join(f"{kind}(CHANNEL)" for kind in KINDS)
            raise InputError(
                f"'{name}' is neither a key figure nor a channel of '{equations.name}'{hint} "
                f"Figures of channels are {kinds}",
                argument="of",
            )
        found.curves += [item for item in curves if item not in found.curves]
        found.others += [item for item in others if item not in found.others]
    found.figures += [(kind, name) for name in found.curves for kind in ("min", "max", "rms")]
    found.figures = list(dict.fromkeys(found.figures))
    return found
