"""Optima of models with corners: found with rounded corners, which are made sharper.

Dry friction that breaks away, as of a limited-slip differential, has corners between which the
search goes to and fro. Rounded they have a slope everywhere: the search sees on which side of a
corner a motion is better, and a motion with slightly rounded corners is near the optimum.
"""

from __future__ import annotations

from dataclasses import replace

from vehicledyn.analyse.optimal_control.shortened import solve_by_shortening
from vehicledyn.analyse.optimal_control.solve import Settings, Solution, solve_on_mesh
from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.analyse.optimal_control.transcription import PointModel

_WIDTHS = 0.2, 0.02, 2e-3
"""Widths of rounded corners one after the other, parts of what meets at a corner."""

_MOST_ITERATIONS = 60
"""Iterations of the search with sharp corners, near the optimum with hardly rounded ones."""

_BARRIER, _ROUGH = 1e-4, 1e-3
"""Parameter of the barrier from one width to the next, and optimality on the way."""


def solve_by_rounding(
    model: PointModel,
    guess: Trajectory,
    settings: Settings,
    on_the_way: Settings,
    *,
    is_near: bool = False,
) -> Solution:
    """Return the optimum on the mesh of a guess, or where and why it was not found.

    Where the search with sharp corners fails it is the optimum with hardly rounded ones, whose
    ``width`` it has.

    Parameters
    ----------
    model
        Of a problem with corners.
    guess
        Where to begin.
    settings
        Of the search at the end, with sharp corners.
    on_the_way
        The same for those before it, with their own watch.
    is_near
        Whether the guess is an optimum of another mesh.
    """
    rough = replace(on_the_way, tolerance=max(_ROUGH, settings.tolerance))
    spent, widths = 0, _WIDTHS[1:]
    trajectory = guess
    if not is_near:
        wide = model.rounded(_WIDTHS[0])
        if model.is_quickest:
            found = solve_by_shortening(wide, guess, guess, rough)
        else:
            found = solve_on_mesh(wide, guess, rough)
        spent, trajectory = found.iterations, found.trajectory
        if found.failure and model.is_quickest:
            found = solve_by_shortening(wide, trajectory, guess, rough)
            spent, trajectory = spent + found.iterations, found.trajectory
        if found.failure:
            return replace(found, iterations=spent)
    for width in widths:
        warm = replace(rough, barrier=_BARRIER)
        if width == _WIDTHS[-1]:
            warm = replace(warm, tolerance=settings.tolerance)
        found = solve_on_mesh(model.rounded(width), trajectory, warm)
        spent, trajectory = spent + found.iterations, found.trajectory
        if found.failure:
            return replace(found, iterations=spent)
    sharp = replace(settings, barrier=_BARRIER)
    sharp = replace(sharp, most_iterations=min(_MOST_ITERATIONS, settings.most_iterations))
    last = solve_on_mesh(model, trajectory, sharp)
    spent += last.iterations
    if last.failure:
        return replace(found, iterations=spent, width=_WIDTHS[-1])
    return replace(last, iterations=spent)
