"""Whether runs with other parameters confirm derivatives that are exact for the steps of one run.

Where a motion passes a jump of its equations that is no event, such as a pin that enters a slot,
the steps on both sides keep their places while the jump moves: their derivatives are exact, but
not those of the motion. Differences of runs are, as far as they are smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import figure_slope
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.moving_jumps import moving_jump
from vehicledyn.analyses.sensitivity.names import START, Directions, RequestedNames
from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]
Runs: TypeAlias = dict[bytes, MotionSlopes]
"""Runs by the bytes of what their parameters are changed by."""

_PART = 1e-3
"""Part of each parameter by which the runs differ."""

_APART, _OFTEN, _USUAL = 0.005, 0.02, 0.9
"""Part of the usual large difference by which a sample is not confirmed, and of the samples, for a
warning; a few samples beside events are none. That difference is the quantile of all."""

_NEAR = 0.02
"""Part of the run's length within which an event counts as beside a sample."""

_SUMS = "rms", "mean", "mean_square", "integral"

_LEAST, _LEAST_SUM = 1e-11, 1e-9
"""Smallest effects on a channel and on a sum that are judged, as parts of their largest values."""


def unconfirmed(
    study: MotionStudy,
    chosen: Directions,
    motion: MotionSlopes,
    channels: Sequence[int],
    runs: Runs | None = None,
) -> list[str]:
    """Return warnings of channels whose derivatives differences of runs do not confirm.

    All parameters are changed at once, by 0.1 % and 0.05 % to both sides, with random signs.

    Parameters
    ----------
    study
        The scenario.
    chosen
        What the derivatives are by; start values and the speed are left out.
    motion
        The motion with its derivatives.
    channels
        Places among the study's channels that are to be judged.
    runs
        Those with other parameters that are known; further ones are added.
    """
    runs = {} if runs is None else runs
    steps = _steps(chosen)
    if not any(steps):
        return []
    try:
        differences = [_difference(study, chosen, part * steps, runs) for part in (1.0, 0.5)]
    except NumericalError as error:
        return [f"warning: runs with parameters changed by 0.1 % fail: {error}"]
    if any(item.shape != motion.values.shape for item in differences):
        return ["warning: runs with parameters changed by 0.1 % end at another time"]
    wide, near = differences
    expected = motion.slopes @ steps
    names = [study.prepared.equations.channels[k].name for k in study.channels]
    notes = []
    for place in channels:
        found = (4.0 * near[:, place] / 0.5 - wide[:, place]) / 3.0
        largest = float(np.quantile(np.abs(found), _USUAL))
        if largest <= _LEAST * np.max(np.abs(motion.values[:, place])) or largest <= _LEAST:
            continue
        errors = np.abs(found - expected[:, place]) / largest
        if np.mean(errors > _APART) > _OFTEN:
            worst = int(np.argmax(errors))
            notes.append(
                f"warning: runs with parameters changed by 0.1 % do not confirm the derivatives of "
                f"'{names[place]}', by up to {errors[worst]:.0%} at {motion.times[worst]:.6g} s"
                f"{_beside(motion, worst)}: the motion passes jumps of its "
                "equations that are no events, or is very sensitive; they are those of these steps"
            )
    return notes


def unconfirmed_figure(
    study: MotionStudy, chosen: Directions, kind: str, slope: Floats
) -> list[str]:
    """Return a warning if differences of runs do not confirm a figure of the first channel.

    Parameters
    ----------
    study, chosen
        As for :func:`unconfirmed`.
    kind
        Name of the figure.
    slope
        Its derivatives, shape (n_directions,).
    """
    try:
        missed = _missed(study, chosen, [(kind, 0)], slope[None], {})
    except NumericalError as error:
        return [f"warning: runs with parameters changed by 0.1 % fail: {error}"]
    if not missed:
        return []
    return [
        "warning: runs with parameters changed by 0.1 % do not confirm the derivatives, by "
        f"{missed[0]:.0%}; they are those of these steps"
    ]


def unconfirmed_of(
    study: MotionStudy, chosen: Directions, motion: MotionSlopes, asked: RequestedNames
) -> list[str]:
    """Return warnings of all that is asked for which differences of runs do not confirm.

    Parameters
    ----------
    study, chosen, motion
        As for :func:`unconfirmed`.
    asked
        Curves and figures, those of the run by any of the study's channels.
    """
    e = study.prepared.equations
    places = {e.channels[k].name: place for place, k in enumerate(study.channels)}
    names = [*asked.curves, *(name for _, name in asked.figures)]
    judged = range(len(places)) if asked.others else [places[n] for n in dict.fromkeys(names)]
    runs: Runs = {}
    notes = unconfirmed(study, chosen, motion, judged, runs)
    figures = [
        (kind, places[name])
        for kind, name in asked.figures
        if not any(f"'{name}'" in note for note in notes)
    ]
    return [*notes, *unconfirmed_sums(study, chosen, motion, figures, runs)]


def unconfirmed_sums(
    study: MotionStudy,
    chosen: Directions,
    motion: MotionSlopes,
    figures: Sequence[tuple[str, int]],
    runs: Runs | None = None,
) -> list[str]:
    """Return warnings of sums over samples that differences of runs do not confirm.

    A jump that moves through few samples, such as that of a rate where a ramp begins, leaves their
    curves as they are but changes their means.

    Parameters
    ----------
    study, chosen, motion
        As for :func:`unconfirmed`.
    figures
        Kinds and places among the study's channels; others than sums are passed over.
    runs
        As for :func:`unconfirmed`.
    """
    sums = [(kind, place) for kind, place in figures if kind in _SUMS]
    names = [study.prepared.equations.channels[k].name for k in study.channels]
    slopes = [_slope(motion, kind, place) for kind, place in sums]
    notes, moves = [], _PART * np.abs(chosen.values)
    for (kind, place), slope in zip(sums, slopes, strict=True):
        if found := moving_jump(motion, kind, place, slope, moves):
            notes.append(
                f"warning: '{names[place]}' jumps at event '{found[0].name}' at "
                f"{found[0].time:.6g} s, whose instant moves; the derivatives of "
                f"'{kind}({names[place]})' are those of its samples, which leave that out, "
                f"by {found[1]:.0%} of the largest; take a figure of a channel that does not jump"
            )
    try:
        missed = _missed(study, chosen, sums, np.array(slopes), {} if runs is None else runs)
    except NumericalError:  # reported with the curves
        return notes
    return notes + [
        f"warning: runs with parameters changed by 0.1 % do not confirm the derivatives of "
        f"'{sums[row][0]}({names[sums[row][1]]})', by {part:.0%} of the largest: a jump of the "
        "channel moves between its samples, or it is very sensitive; they are those of these "
        "samples"
        for row, part in missed.items()
    ]


def _slope(motion: MotionSlopes, kind: str, place: int) -> Floats:
    """Return the derivatives of a figure of a channel."""
    values, slopes = motion.values[:, place], motion.slopes[:, place]
    return figure_slope(kind, motion.times, values, slopes, motion.end_slope).slope


def _missed(
    study: MotionStudy,
    chosen: Directions,
    figures: Sequence[tuple[str, int]],
    slopes: Floats,
    runs: Runs,
) -> dict[int, float]:
    """Return which figures differences of runs do not confirm, and by which part.

    Raises
    ------
    NumericalError
        If such a run fails.
    """
    steps = _steps(chosen)
    if not any(steps) or not figures:
        return {}
    ends = []
    for part in (1.0, -1.0, 0.5, -0.5):
        motion = _run(study, chosen, part * steps, runs)
        none = np.zeros((len(motion.times), 0))
        columns = motion.values.T
        ends.append([figure_slope(k, motion.times, columns[c], none).value for k, c in figures])
    end = np.array(ends)
    found = (4.0 * (end[2] - end[3]) - (end[0] - end[1]) / 2.0) / 3.0
    expected = slopes @ steps
    scale = np.max(np.abs(slopes * steps), axis=1)
    scale = np.maximum(np.maximum(scale, np.abs(expected)), _LEAST_SUM * np.abs(end[0]))
    part = np.abs(found - expected) / np.where(scale > 0.0, scale, 1.0)
    return {row: float(part[row]) for row in np.flatnonzero(part > _APART).tolist()}


def _beside(motion: MotionSlopes, sample: int) -> str:
    """Return words on the event nearest to a sample, none where no event is near."""
    time, near = motion.times[sample], _NEAR * float(np.ptp(motion.times))
    event = min(motion.events, key=lambda item: abs(item.time - time), default=None)
    if event is None or abs(event.time - time) > near:
        return ""
    return f", beside event '{event.name}' at {event.time:.6g} s"


def _steps(chosen: Directions) -> Floats:
    """Return by how much each quantity is changed, none for start values and the speed."""
    signs = np.random.default_rng(1).choice([-1.0, 1.0], len(chosen.values))
    names = [item.name for item in chosen.quantities]
    moves = np.array([not name.startswith(START) and name != "speed" for name in names])
    return np.asarray(_PART * signs * chosen.values * moves, dtype=float)


def _difference(study: MotionStudy, chosen: Directions, steps: Floats, runs: Runs) -> Floats:
    """Return half the difference of runs to both sides, shape (n_times, n_channels)."""
    sides = [_run(study, chosen, sign * steps, runs).values for sign in (1.0, -1.0)]
    if sides[0].shape != sides[1].shape:
        return np.zeros((0, 0))
    return np.asarray(0.5 * (sides[0] - sides[1]), dtype=float)


def _run(study: MotionStudy, chosen: Directions, steps: Floats, runs: Runs) -> MotionSlopes:
    """Return the run with parameters changed by steps, of those known if it is among them."""
    key = steps.tobytes()
    if key not in runs:
        runs[key] = study.moved(_changes(chosen, steps)).plain(lambda *_: None)
    return runs[key]


def _changes(chosen: Directions, steps: Floats) -> dict[str, float]:
    """Return the values of the quantities that are changed."""
    rows = zip(chosen.quantities, chosen.values, steps, strict=True)
    return {item.name: float(value + step) for item, value, step in rows if step}
