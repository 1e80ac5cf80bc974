"""What a scenario wants of a run: channels to write, channels for key figures, figures."""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence
from typing import Any

from vehicledyn.analyses.preparation.error_locations import wrong_output
from vehicledyn.analyses.preparation.prepared import Derived, Prepared
from vehicledyn.base.errors import nearest_name, unknown_name
from vehicledyn.files.scenario import LoadedScenario


def written_channels(
    loaded: LoadedScenario, derived: Derived | Prepared
) -> tuple[list[int], list[dict[str, Any]]]:
    """Return channels and figures to write; refuse unknown ones, and what the solver cannot do."""
    kept = _kept_channels(loaded, derived)
    described = _plots(loaded, derived, kept)
    # Only methods that cannot treat every model have a check.
    check = getattr(loaded.scenario.solver, "check", None)
    if check is not None:
        check(derived.equations)
    return kept, described


def _kept_channels(loaded: LoadedScenario, prepared: Derived | Prepared) -> list[int]:
    """Return the channels to write; an unknown pattern is an error before the run."""
    names = [c.name for c in prepared.equations.channels]
    patterns = loaded.scenario.output.channels
    if patterns is None:
        return list(range(len(names)))
    problems = []
    for pattern in patterns:
        if not fnmatch.filter(names, pattern):
            guess = nearest_name(pattern, names)
            hint = f"; did you mean '{guess}'?" if guess else ""
            problems.append((pattern, f"'{pattern}' matches no channel{hint}"))
    if problems:
        raise wrong_output(loaded, "channels", problems)
    return [k for k, n in enumerate(names) if any(fnmatch.fnmatchcase(n, p) for p in patterns)]


def needed_channels(prepared: Prepared) -> list[int]:
    """Return the channels the summary is made from, kept or not."""
    names = [c.name for c in prepared.equations.channels]
    return [names.index(n) for n in prepared.subject.channels(prepared.equations)]


def _plots(
    loaded: LoadedScenario, prepared: Derived | Prepared, kept: Sequence[int]
) -> list[dict[str, Any]]:
    """Return the figures asked for, those whose channels are kept."""
    described = prepared.subject.plots(prepared.equations)
    names = {prepared.equations.channels[k].name for k in kept}
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
