"""Values of parameters that a study allows but a model refuses, such as a mass of zero.

Cases of optimisations, identifications and uncertainties take other parameters without reading
files again, so that what these would refuse is looked at once, at the ends of the ranges.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity


def refused_ends(
    scenarios: Iterable[LoadedScenario],
    ends: Mapping[str, tuple[float, float]],
    now: Mapping[str, float],
    about: Mapping[str, Quantity],
) -> dict[str, str]:
    """Return why models refuse an end of the range of parameters, by their names.

    What only several of them together would be refused for is no mistake.

    Parameters
    ----------
    scenarios
        What the parameters are of.
    ends
        Lowest and highest value of each parameter, in SI, by name.
    now, about
        Their present values and their units by name.
    """
    found: dict[str, str] = {}
    for loaded in scenarios:
        for side in range(2):
            values = {name: pair[side] for name, pair in ends.items()}
            if _refusal(loaded, values, about) is None:
                continue
            for name, value in values.items():
                why = _refusal(loaded, {name: value}, about)
                if why is None or _refusal(loaded, {name: now[name]}, about) is not None:
                    continue  # a name that files do not know, such as that of a mirrored part
                size = shown(value, about[name].unit)
                found.setdefault(name, f"the model refuses {size}: {why}; narrow the range")
    return found


def _refusal(
    loaded: LoadedScenario, values: Mapping[str, float], about: Mapping[str, Quantity]
) -> str | None:
    """Return why a scenario refuses values of parameters, None if it takes them."""
    texts = [f"parameters.{name}={written(v, about[name].unit)}" for name, v in values.items()]
    try:
        loaded.with_overrides(texts)
    except InputError as error:
        return str(error).splitlines()[0]
    return None


def written(value: float, unit: str) -> str:
    """Return a value in SI as files write it."""
    return repr(value) if unit in ("1", "") else f"{value!r} {unit}"
