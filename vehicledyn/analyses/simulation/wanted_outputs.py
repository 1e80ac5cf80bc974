"""What a scenario wants of a run: channels to write, channels for key figures, figures."""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from vehicledyn.analyses.preparation.error_locations import errors_with_locations, wrong_output
from vehicledyn.base.errors import NumericalError, nearest_name, unknown_name
from vehicledyn.base.interrupts import undisturbed
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.near_names import near
from vehicledyn.symbolic.equations import Channel

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepared import Derived, Prepared
    from vehicledyn.analyses.preparation.runnable import Subject


def written_channels(
    loaded: LoadedScenario, prepared: Prepared
) -> tuple[list[int], list[dict[str, Any]]]:
    """Return channels and figures to write; refuse unknown ones, and what the solver cannot do."""
    _check_solver(loaded, prepared)
    return _wanted(loaded, prepared.subject, prepared.equations.channels)


def check_run(loaded: LoadedScenario, derived: Derived) -> None:
    """Refuse unknown channels and figures before anything is derived; then what no solver can do.

    Raises
    ------
    InputError
        With all unknown channels, or that the solver cannot treat these equations.
    """
    check_outputs(loaded, derived.subject)
    _check_solver(loaded, derived)


def check_outputs(loaded: LoadedScenario, subject: Subject) -> list[Channel]:
    """Refuse channels and figures that a scenario asks for and its subject will not have.

    Returns the channels that it will have; none are sought where it asks for none.

    Raises
    ------
    InputError
        With all of them.
    NumericalError
        If the loops of the subject cannot be assembled.
    """
    if not loaded.asks_for_outputs:
        return []
    from vehicledyn.multibody.equations.channel_outline import outline_channels

    with undisturbed(), errors_with_locations(loaded):
        channels = outline_channels(subject.system)
    _wanted(loaded, subject, channels)
    return channels


def validate_outputs(loaded: LoadedScenario) -> None:
    """Refuse channels and figures that a scenario asks for in vain, without running it.

    Channels that were found for the same model, surroundings and start are not sought again.

    Raises
    ------
    InputError
        With all of them. Loops that cannot be assembled are left to the run to report.
    """
    from vehicledyn.analyses.preparation.memory.run_cache import (
        key_of_run,
        recall_channels,
        remember_channels,
    )

    key = key_of_run(loaded)
    known = None if key is None else recall_channels(key)
    if known is not None and loaded.scenario.output.plots is None:
        _kept_channels(loaded, known)
        return
    from vehicledyn.analyses.preparation.build_model import build_subject

    with suppress(NumericalError), errors_with_locations(loaded):
        channels = check_outputs(loaded, build_subject(loaded))
        if key is not None and channels:
            remember_channels(key, channels)


def _check_solver(loaded: LoadedScenario, derived: Derived | Prepared) -> None:
    """Refuse equations that the solver cannot treat; only some methods have a check."""
    check = getattr(loaded.scenario.solver, "check", None)
    if check is not None:
        check(derived.equations)


def _wanted(
    loaded: LoadedScenario, subject: Subject, channels: Sequence[Channel]
) -> tuple[list[int], list[dict[str, Any]]]:
    kept = _kept_channels(loaded, channels)
    return kept, _plots(loaded, subject, channels, kept)


def _kept_channels(loaded: LoadedScenario, channels: Sequence[Channel]) -> list[int]:
    """Return the channels to write; an unknown pattern is an error before the run."""
    names = [c.name for c in channels]
    patterns = loaded.scenario.output.channels
    if patterns is None:
        return list(range(len(names)))
    problems = []
    for pattern in patterns:
        if not fnmatch.filter(names, pattern):
            guess = nearest_name(pattern, names)
            hint = f"; did you mean '{guess}'?" if guess else f"; {near(pattern, names)}"
            problems.append((pattern, f"'{pattern}' matches no channel{hint}"))
    if problems:
        raise wrong_output(loaded, "channels", problems)
    return [k for k, n in enumerate(names) if any(fnmatch.fnmatchcase(n, p) for p in patterns)]


def needed_channels(prepared: Prepared) -> list[int]:
    """Return the channels the summary is made from, kept or not."""
    names = [c.name for c in prepared.equations.channels]
    return [names.index(n) for n in prepared.subject.channels(prepared.equations)]


def _plots(
    loaded: LoadedScenario, subject: Subject, channels: Sequence[Channel], kept: Sequence[int]
) -> list[dict[str, Any]]:
    """Return the figures asked for, those whose channels are kept."""
    described = subject.plots(channels)
    names = {channels[k].name for k in kept}
    wanted = loaded.scenario.output.plots
    known = [str(plot["name"]) for plot in described]
    for name in wanted or ():
        if name not in known:
            problem = (name, unknown_name("plot", name, known))
            raise wrong_output(loaded, "plots", [problem])
    chosen = [p for p in described if wanted is None or p["name"] in wanted]
    return [plot for plot in chosen if _plot_channels(plot) <= names]


def _plot_channels(plot: dict[str, Any]) -> set[str]:
    if plot["kind"] == "path":
        return {plot["x"], plot["y"], plot.get("heading") or plot["x"]}
    return {channel for panel in plot["panels"] for channel in panel["channels"]}
