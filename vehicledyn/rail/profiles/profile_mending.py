"""Measured points without their defects: outliers left out, gaps bridged by a smooth curve."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import MOST_SHOWN, Mark, Problem, refusal
from vehicledyn.rail.profiles.profile_defects import MOST_OUTLIERS, find_defects
from vehicledyn.rail.profiles.profile_defects import Defects as Found
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.rail.profiles.profile_points import RawPoints
from vehicledyn.rail.profiles.profile_reading import Defects

_WINDOW, _FEWEST = 3e-3, 6
"""Length and number of the points beside a gap from which its bridge takes its direction."""

_SHOWN = MOST_SHOWN - 2
_MILLI = 1e3


@dataclass(frozen=True)
class Mended:
    """Points in their order, the number of the file's line of each, and what was done.

    ``outliers`` are the points left out, shape (n, 2), ``bridges`` the y at both ends of each
    bridged gap, shape (n, 2) [m].
    """

    points: Floats
    lines: NDArray[np.int_]
    outliers: Floats
    bridges: Floats
    notes: list[str]


def mended(raw: RawPoints, points: Floats, defects: Defects) -> Mended:
    """Return the points of a file with their defects refused, mended or kept.

    Parameters
    ----------
    raw
        The points as the file has them, for messages.
    points
        The same in metres, shape (n, 2).
    defects
        What to do with defects.

    Raises
    ------
    InputError
        If there are defects that are not to be mended or kept, or too many outliers; one line
        each with file, line and place.
    """
    lines = np.array(raw.lines)
    none = np.zeros((0, 2))
    if defects == "keep":
        return Mended(points, lines, none, none, [])
    found = find_defects(points)
    if found.steps or (defects == "refuse" and (found.outliers or found.gaps)):
        raise _refused(raw, points, found)
    stray = len(found.outliers) - len(found.in_patches)
    if stray > MOST_OUTLIERS * len(points):
        message = f"{stray} of {len(points)} points are outliers: this is no profile"
        raise raw.refused(raw.lines[next(iter(found.outliers))], 1, message)
    left = np.array([k for k in range(len(points)) if k not in found.outliers], dtype=int)
    kept, kept_lines, bridges = points[left], lines[left], []
    for gap in reversed(found.gaps):
        at = int(np.searchsorted(left, gap))
        bridge = _bridge(kept, at)
        bridges.append((kept[at, 0], kept[at + 1, 0]))
        kept = np.insert(kept, at + 1, bridge, axis=0)
        kept_lines = np.insert(kept_lines, at + 1, [kept_lines[at]] * len(bridge))
    notes = [f"left out: {words}" for _, words in _runs(raw, points, found)]
    notes += [f"bridged: {words}" for _, words in _stretches(raw, points, found)]
    outliers = points[list(found.outliers)] if found.outliers else none
    return Mended(kept, kept_lines, outliers, np.array(bridges).reshape(-1, 2), notes)


def _refused(raw: RawPoints, points: Floats, found: Found) -> InputError:
    gaps = tuple(k for k in found.gaps if k + 1 not in found.in_patches)
    given = replace(found, gaps=gaps)
    defects = sorted(
        [*_runs(raw, points, given), *_stretches(raw, points, given), *_steps(raw, points, given)]
    )
    problems = [Problem(raw.file, Mark(line, 1), "", words) for line, words in defects[:_SHOWN]]
    if len(defects) > _SHOWN:
        more = f"{len(defects) - _SHOWN} more defects"
        problems.append(Problem(raw.file, Mark(defects[_SHOWN][0], 1), "", more))
    hint = "mend leaves outliers out and bridges gaps, keep takes the points as they are"
    if found.steps:
        hint = "no one can mend a step: measure again, or keep takes the points as they are"
    problems.append(
        Problem(raw.file, Mark(raw.lines[-1], 1), "defects", f"say what to do with them: {hint}")
    )
    return refusal(problems, raw.file)


def _runs(raw: RawPoints, points: Floats, found: Found) -> list[tuple[int, str]]:
    """Return line and words of each run of outliers beside each other."""
    numbers = np.array(list(found.outliers), dtype=int)
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1) if len(numbers) else []
    described = []
    for run in runs:
        size = max(found.outliers[int(k)] for k in run)
        count = "an outlier" if len(run) == 1 else f"{len(run)} outliers, the first"
        until = "" if len(run) == 1 else f", the last in line {raw.lines[run[-1]]}"
        place = ", ".join(f"{_MILLI * value:.4g}" for value in points[run[0]])
        words = (
            f"{count} in line {raw.lines[run[0]]} at ({place}) mm{until}, {_MILLI * size:.3g} mm "
            "beside the curve through the points around"
        )
        described.append((raw.lines[int(run[0])], words))
    return described


def _stretches(raw: RawPoints, points: Floats, found: Found) -> list[tuple[int, str]]:
    """Return line and words of each gap."""
    described = []
    for gap in found.gaps:
        behind = next(k for k in range(gap + 1, len(points)) if k not in found.outliers)
        length = _MILLI * float(np.hypot(*(points[behind] - points[gap])))
        ends = f"y = {_MILLI * points[gap, 0]:.4g} to {_MILLI * points[behind, 0]:.4g} mm"
        line = raw.lines[gap]
        described.append((line, f"a gap of {length:.3g} mm after line {line}, {ends}"))
    return described


def _steps(raw: RawPoints, points: Floats, found: Found) -> list[tuple[int, str]]:
    """Return line and words of each step that bounds no patch."""
    described = []
    for step in found.steps:
        before, behind = (f"{_MILLI * points[k, 0]:.4g}" for k in (step.before, step.behind))
        line = raw.lines[step.before]
        words = f"a step of {_MILLI * abs(step.height):.3g} mm after line {line}"
        described.append((line, f"{words}, between y = {before} and {behind} mm"))
    return described


def _bridge(points: Floats, at: int) -> Floats:
    """Return points between two, along a cubic that goes on as the points beside the gap do."""
    before, behind = points[: at + 1][::-1], points[at + 1 :]
    across = points[at + 1] - points[at]
    (first, leaving), (last, arriving) = _end(before, across), _end(behind, -across)
    length = float(np.hypot(*(last - first)))
    spacing = float(np.median(np.hypot(*np.diff(points, axis=0).T)))
    count = max(round(length / spacing) - 1, 1)
    u = np.linspace(0.0, 1.0, count + 2)[1:-1, None]
    rest = 1.0 - u
    ends = rest**2 * (1.0 + 2.0 * u) * first + u**2 * (3.0 - 2.0 * u) * last
    # Both directions point into the gap.
    return np.asarray(ends + length * u * rest * (rest * leaving + u * arriving))


def _end(points: Floats, across: Floats) -> tuple[Floats, Floats]:
    """Return the end of a curve that begins at the gap, and its direction into the gap.

    Of too few points the direction is that to the other side, ``across``.
    """
    if len(points) < _FEWEST // 2:
        return points[0], across / np.hypot(*across)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = min(len(points), max(_FEWEST, int(np.searchsorted(along, _WINDOW))))
    weights = np.polynomial.polynomial.polyfit(along[:count], points[:count], 2)
    direction = -weights[1]
    return weights[0], direction / np.hypot(*direction)
