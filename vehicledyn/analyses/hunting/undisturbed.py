"""A hunting study's target without the disturbances of its scenario."""

from __future__ import annotations

from vehicledyn.analyses.hunting.parameter_starts import starts_of
from vehicledyn.analyses.hunting.start import HuntSettings, span_of
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.own_speed import at_value
from vehicledyn.files.scenario.target import Target


def without_disturbances(target: Target, settings: HuntSettings) -> tuple[Target, list[str]]:
    """Return a target that starts from the steady motion of its system, and what was set aside.

    Where the system's own start follows the parameter, as the spin of wheels follows a speed, it
    says which of many steady motions is meant, and a scenario's ``initial`` would lead to another
    one. Other targets are returned as they are, and changes of ``initial`` from outside the file
    are kept.

    Raises
    ------
    InputError
        If the range is none of the parameter.
    """
    chosen = target.choices
    if chosen is None:
        return target, []
    name, given = settings.parameter, chosen.initial
    unit = target.written.units.get(name)
    if not given or unit is None:
        return target, []
    plain = target.with_overrides((), first=("initial={}",))
    kept = {} if plain.choices is None else plain.choices.initial
    aside = [key for key in given if key not in kept]
    first, last = (
        starts_of(build_subject(at_value(plain, name, value, unit)))
        for value in span_of(unit, settings)
    )
    if not aside or first == last:
        return target, []
    words = (
        f"'initial' of the scenario is set aside ({', '.join(aside)}): the equilibrium at each "
        f"{name} is that of the system's own start"
    )
    return plain, [words]
