"""The verb "rig": kinematics and compliance of an axle on a suspension rig."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.rig_bench import Bench
from vehicledyn.analyses.mechanism.rig_corners import RigCorners
from vehicledyn.analyses.mechanism.rig_quantities import WheelPlace
from vehicledyn.analyses.mechanism.rig_report import RigReport, corner_notes, figures
from vehicledyn.analyses.mechanism.rig_tests import TESTS, RigTest, of_one_wheel
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.layout import ResultHeader, SampleAxis, SummaryEntry
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RigRequest:
    """What to do on the rig.

    ``values`` are those of the control, as "FROM:TO:STEPS"; ``travel`` lifts the wheels beside it
    [m], so that loads and steering act at another height; ``steering`` is what steers.
    """

    test: str
    values: str | None = None
    travel: float = 0.0
    steering: str | None = None


def run_rig(
    target: Target,
    request: RigRequest,
    *,
    output: Path,
    progress: Progress,
    kept: KeptWork | None = None,
) -> RigReport:
    """Put an axle on the rig and write the result file.

    Parameters
    ----------
    target
        A system with sensors ``wheel_angles``, or a scenario of one.
    request
        What to do.
    output
        Result file; checked before anything is computed.
    progress
        Called with what is going on and the part done.
    kept
        What is kept of it meanwhile.

    Raises
    ------
    InputError
        If the test or its range is wrong, or the system has nothing to put on the rig.
    NumericalError
        If the loops cannot be assembled at the design position.
    """
    check_output(output)
    try:
        test = named_test(request.test)
    except InputError as error:
        raise InputError(f"{argument('test')}: {error}") from None
    values = values_of(test, request.values)
    progress("assembling the axle", None)
    bench = Bench(target, request.steering)
    check_test(bench, request.test, target)
    bench.lift(request.travel)
    memory = (kept or KeptWork()).memory("rig", request, bench.facts)
    row = partial(_row, bench, test, RigCorners(bench))
    table, failure = swept(bench, test, values, row, progress=progress, memory=memory)
    n = len(channels_of(bench, test))
    sides = table[:, n:].reshape(len(table), 2, n - 1)
    return _write(target, request.test, bench, (table[:, :n], failure, sides), output)


def named_test(name: str) -> RigTest:
    """Return a test by its name; raises InputError if there is none."""
    if name not in TESTS:
        raise InputError(unknown_name("test", name, TESTS))
    return TESTS[name]


def values_of(test: RigTest, text: str | None) -> Array:
    """Return values of a test's control, the usual ones if none are given.

    Raises
    ------
    InputError
        If the text is no range of values.
    """
    if text is None:
        first, last, steps = test.usual
        return np.linspace(first, last, steps + 1)
    try:
        return np.asarray(read_range(text).values(test.unit))
    except InputError as error:
        raise InputError(f"values of {test.control}: {error}") from None


def check_test(bench: Bench, name: str, target: Target) -> None:
    """Raise InputError if a test needs what the axle has not."""
    if name == "steer" and not bench.steering:
        raise InputError(
            f"{target.origin}: the test 'steer' needs a coordinate that steers; name it with "
            f"{argument('steering')}"
        )


def swept(
    bench: Bench,
    test: RigTest,
    values: Array,
    at: Callable[[float], Array],
    *,
    progress: Progress,
    memory: Memory,
) -> tuple[Array, str]:
    """Return what is found at each value of the control, and where the way out ended before.

    Two ways lead out from the value nearest to zero, so that each place is followed from its
    neighbour.

    Parameters
    ----------
    bench, test
        The axle and what it is put through.
    values
        Values of the control, ascending.
    at
        Returns what is wanted at a value, an array of always the same shape.
    progress
        Called with what is going on and the part done.
    memory
        Knows places found before.

    Raises
    ------
    NumericalError
        If the first place is not found.
    """
    middle = int(np.argmin(np.abs(values)))
    rows: dict[int, Array] = {}
    failure = ""

    def found(value: float) -> tuple[Array, tuple[Array, Array]]:
        return at(value), bench.place

    for way in (range(middle, len(values)), range(middle - 1, -1, -1)):
        bench.restart()
        for k in way:
            try:
                value, place = float(values[k]), bench.place
                rows[k], bench.place = memory.recall_or_raise(
                    "place", (value, place), partial(found, value)
                )
            except NumericalError as error:
                if not rows:
                    raise
                failure = f"no place at {test.control} = {values[k]:.6g} {test.unit}: {error}"
                break
            progress("on the rig", len(rows) / len(values))
    return np.array([rows[k] for k in sorted(rows)]), failure


def ways(bench: Bench, test: RigTest) -> list[dict[str, float]]:
    """Return the directions of the rig's parameters that the quantities of a test need slopes of.

    The first is that of the control; those that lift one wheel come after it in a test that steers.
    """
    one_by_one = range(len(bench.corners)) if test.control == "steering" else ()
    return [test.controls(bench, 1.0), *(of_one_wheel("travel", k)(bench, 1.0) for k in one_by_one)]


def quantities(
    bench: Bench,
    test: RigTest,
    seen: Mapping[str, complex],
    slopes: Sequence[Mapping[str, complex]],
) -> list[complex]:
    """Return all quantities of a test at a place, analytic in what they are drawn from.

    Parameters
    ----------
    bench, test
        The axle and what it is put through.
    seen
        Channels at rest.
    slopes
        Theirs along the :func:`ways` of the test.
    """
    places = [_place(bench, k, seen, slopes[0]) for k in range(len(bench.corners))]
    for k, lifted in enumerate(slopes[1:]):
        places[k] = _steered(bench, k, places[k], seen, (slopes[0], lifted))
    found = [item.value(place) for place in places for item in test.quantities]
    return [*found, *_axle(bench, test, seen, slopes[0])]


def _row(bench: Bench, test: RigTest, corners: RigCorners, value: float) -> Array:
    """Return a value, the quantities there, and these below and above it where they jump."""
    found = _found(bench, test, value)
    sides = np.full((2, len(found)), np.nan)
    jumping = corners.sides(test, value, partial(_found, bench))
    if jumping.size:
        sides = jumping
    return np.concatenate([[value], found, sides.ravel()])


def _found(bench: Bench, test: RigTest, value: float) -> Array:
    """Return the quantities at a value."""
    seen = bench.at(test.controls(bench, value))
    return np.array(quantities(bench, test, seen, bench.slopes(*ways(bench, test)))).real


def _steered(
    bench: Bench,
    corner: int,
    place: WheelPlace,
    seen: Mapping[str, complex],
    slopes: tuple[Mapping[str, complex], Mapping[str, complex]],
) -> WheelPlace:
    """Return a wheel that also knows how it steers while its spring keeps its length."""
    by_steering, by_travel = slopes
    spring = max(bench.lengths, key=lambda name: abs(by_travel[name]), default=None)
    share: complex = 0.0
    if spring is not None and by_travel[spring] != 0.0:
        share = -by_steering[spring] / by_travel[spring]
    mixed = {n: by_steering[n] + share * by_travel[n] for n in seen}
    return replace(place, steered=_place(bench, corner, seen, mixed))


def _place(
    bench: Bench, corner: int, seen: Mapping[str, complex], slopes: Mapping[str, complex]
) -> WheelPlace:
    head = f"{bench.corners[corner].name}."
    values, changes = (
        {n.removeprefix(head): x for n, x in given.items() if n.startswith(head)}
        | {"load": given[bench.pad(corner)]}
        for given in (seen, slopes)
    )
    is_left = bench.corners[corner].side == "left"
    return WheelPlace(
        is_left, values, changes, bench.turn(corner, seen), bench.turn(corner, slopes)
    )


def _axle(
    bench: Bench, test: RigTest, seen: Mapping[str, complex], slopes: Mapping[str, complex]
) -> list[complex]:
    """Return what is of the whole axle: roll stiffness, Ackermann difference, steering force."""
    names = [corner.name for corner in bench.corners]
    if test.control == "roll":
        arms = [(seen[f"{n}.contact_y"], slopes[f"{n}.contact_y"]) for n in names]
        loads = [(seen[bench.pad(k)], slopes[bench.pad(k)]) for k in range(len(names))]
        pairs = zip(arms, loads, strict=True)
        return [sum(y * dn + dy * n for (y, dy), (n, dn) in pairs)]
    if test.control == "steering":
        force = seen.get(f"{bench.steering}_force", float("nan"))
        sides = {c.side: seen[f"{c.name}.steer_angle"] for c in bench.corners}
        return [force, sides.get("left", np.nan) - sides.get("right", np.nan)]
    return []


def _axle_channels(test: RigTest) -> Iterator[Channel]:
    if test.control == "roll":
        yield Channel(
            "axle.roll_stiffness", "N*m/rad", "Roll stiffness of the axle, tyres left out"
        )
    if test.control == "steering":
        yield Channel("axle.steering_force", "N", "Force on the steering coordinate")
        yield Channel(
            "axle.steer_difference", "rad", "Steer angle of the left wheel less the right"
        )


def channels_of(bench: Bench, test: RigTest) -> list[Channel]:
    """Return the channels of a test: its control, then all quantities."""
    found = [Channel(test.control, test.unit, test.text)]
    for corner in bench.corners:
        found += [
            Channel(f"{corner.name}.{item.name}", item.unit, item.description)
            for item in test.quantities
        ]
    return [*found, *_axle_channels(test)]


def _write(
    target: Target, name: str, bench: Bench, swept: tuple[Array, str, Array], output: Path
) -> RigReport:
    table, failure, sides = swept
    test = TESTS[name]
    channels = channels_of(bench, test)
    notes = corner_notes(channels, table[:, 0], sides)
    known = [k for k in range(len(channels)) if np.isfinite(table[:, k]).any()]
    channels, table = [channels[k] for k in known], table[:, known]
    status = "failed" if failure else "ok"
    header = ResultHeader(
        title=f"Rig test '{name}' of {target.title}",
        model=target.model_name,
        plots=figures(channels, table, [corner.name for corner in bench.corners]),
        axis=SampleAxis("1", "Number of the place"),
    )
    middle = int(np.argmin(np.abs(table[:, 0])))
    with ResultWriter(
        output, channels=channels, header=header, expected_samples=len(table)
    ) as writer:
        writer.append(np.arange(len(table), dtype=float), table)
        writer.close(status, failure, summary=list(_summary(channels, table[middle])), notes=notes)
    return RigReport(
        target.model_name, name, output, status, tuple(channels), table, middle, failure, notes
    )


def _summary(channels: Sequence[Channel], row: Array) -> Iterator[SummaryEntry]:
    for channel, value in zip(channels, row, strict=True):
        if np.isfinite(value):
            yield SummaryEntry(channel.name, float(value), channel.unit, channel.description)
