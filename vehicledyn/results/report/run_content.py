"""What a page shows of a run: motion over time, or a kinematic sweep."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.report import assess_result
from vehicledyn.results.assessment.subjects import find_subjects
from vehicledyn.results.info import ChannelRange, channel_ranges
from vehicledyn.results.plots.figures import draw_figure
from vehicledyn.results.plots.run_plots import plots_of
from vehicledyn.results.report.content import Content, Figures, ReportFigure, key_table, words
from vehicledyn.results.report.page import Block, Facts, Listing, Notes, Section, TextTable
from vehicledyn.results.report.texts import moment, number, reading, unit_text
from vehicledyn.results.store.reader import Result, open_result

_LOG = logging.getLogger(__name__)

MOST_SAMPLES = 8000
"""Samples of a channel that figures show; of more their envelope."""
MOST_FIGURES = 24
MOST_EVENTS = 50
MOST_NAMED = 12

MOST_ASSESSED = 1_000_000
"""Samples of a run up to which it is assessed."""
ASSESSMENT = "Running safety, comfort and wear"

ACCURACY = ("largest_loop_gap", "largest_loop_speed", "energy_drift")
"""Key figures that tell how exact a run is."""
LABELS = {
    "generation_seconds": "Time to derive the equations",
    "compilation_seconds": "Time to compile them",
    "kernel_from_cache": "Taken from the cache",
    "wall_seconds": "Time to integrate",
}
APART = ("system", "units", "overrides", "title", "description", "model", "output")


def run_content(path: Path) -> Content:
    """Return what a page shows of a run."""
    ranges = cache(lambda: _ranges(path))
    with open_result(path, MOST_SAMPLES) as result:
        key_figures = [
            ReportFigure(e.name, e.value, e.unit, e.description) for e in result.summary.values()
        ]
        accuracy = [figure for figure in key_figures if figure.name in ACCURACY]
        return Content(
            path=path,
            what="Simulation" if result.is_timed else "Kinematics",
            title=result.title,
            state="" if result.is_whole else result.state_of_run,
            facts=_facts(result),
            key_figures=[k for k in key_figures if k.name not in ACCURACY],
            figures=lambda: _figures(path),
            details=lambda: _details(path, ranges(), accuracy),
            warnings=lambda: _warnings(path, ranges()),
        )


def _facts(result: Result) -> list[tuple[str, str]]:
    known = result.configuration
    rows = [("Model", result.model)]
    for name in ("manoeuvre", "road", "driver", "solver"):
        kind = known.get(name, {})
        if isinstance(kind, dict) and kind.get("kind"):
            rows.append((words(name), str(kind["kind"]).replace("_", " ")))
    if isinstance(known.get("speed"), int | float):
        rows.append(("Speed at the start", reading(float(known["speed"]), "m/s")))
    if result.samples:
        first, last = number(float(result.time[0])), number(float(result.time[-1]))
        span = f"{first} to {last} s, " if result.is_timed else ""
        rows.append(("Time" if span else "Positions", f"{span}{result.samples} samples"))
    if isinstance(known.get("overrides"), list) and known["overrides"]:
        rows.append(("Changed values", ", ".join(map(str, known["overrides"]))))
    digest = f", equations and parameters {result.model_hash[:12]}" if result.model_hash else ""
    origin = f"{moment(result.created)} by vehicledyn {result.program_version}{digest}"
    return [*rows, ("Status", result.status), ("Computed", origin)]


def _ranges(path: Path) -> tuple[ChannelRange, ...]:
    with open_result(path, MOST_SAMPLES) as result:
        return channel_ranges(result)


def _warnings(path: Path, ranges: Sequence[ChannelRange]) -> list[str]:
    with open_result(path, MOST_SAMPLES) as result:
        found = list(result.notes)
        if result.is_whole and result.status_message:
            found.append(result.status_message)
        bad = [c for c in ranges if c.not_finite]
        if bad:
            named = ", ".join(f"{c.name} ({c.not_finite})" for c in bad[:MOST_NAMED])
            more = f" and {len(bad) - MOST_NAMED} more" if len(bad) > MOST_NAMED else ""
            found.append(
                f"Values that are not finite, left out of figures and ranges: {named}{more}."
            )
        if not result.samples:
            found.append("The file holds no samples: there is nothing to draw.")
        elif result.samples > len(result.time):
            found.append(
                f"Figures show the envelope of {result.samples} samples, smallest and largest "
                f"value of every {result.block}."
            )
    return found


def _figures(path: Path) -> Figures:
    with open_result(path, MOST_SAMPLES) as result:
        if not result.samples:
            return
        for plot in plots_of(result)[:MOST_FIGURES]:
            try:
                yield plot.name, draw_figure(result, plot)
            except (InputError, ArithmeticError, ValueError) as error:
                _LOG.warning("%s: figure '%s' cannot be drawn: %s", path, plot.name, error)


def _details(
    path: Path, ranges: Sequence[ChannelRange], accuracy: Sequence[ReportFigure]
) -> list[Section]:
    with open_result(path, MOST_SAMPLES) as result:
        sections = [
            *_assessment(result),
            Section("Events", list(_events(result))),
            Section("Accuracy", _accuracy(result, accuracy)),
            Section("Solver", [TextTable(("Statistic", "Value"), _solver(result.solver), (1,))]),
            Section("Parts used and their sources", list(_parts(result))),
            Section("Channels", [_channels(ranges)]),
            Section("Input", list(_input(result))),
        ]
    return [section for section in sections if any(_holds(block) for block in section.blocks)]


def _holds(block: Block) -> bool:
    return not isinstance(block, TextTable) or bool(block.rows)


def _assessment(result: Result) -> Iterator[Section]:
    """Yield the assessment of a run on rails by the standards."""
    on_rails = bool(find_subjects(result.units).axles) and result.is_timed and result.samples
    if not on_rails or result.samples > MOST_ASSESSED:
        return
    try:
        lines = assess_result(result.path).as_text().splitlines()
    except InputError as error:
        yield Section(ASSESSMENT, [Notes([str(error)])])
        return
    first = next((k for k, line in enumerate(lines) if not line), 0)
    if not result.is_whole:
        first = next((k for k, line in enumerate(lines[first + 1 :], first + 1) if not line), first)
    yield Section(ASSESSMENT, [Listing("", "\n".join(lines[first:]).strip("\n"))])


def _events(result: Result) -> Iterator[Block]:
    events = result.events
    if events:
        rows = [(event.name, reading(event.time, "s")) for event in events[:MOST_EVENTS]]
        yield TextTable(("Event", "Instant"), rows, numbers=(1,))
    if len(events) > MOST_EVENTS:
        yield Notes([f"{len(events) - MOST_EVENTS} more events are in the file."])


def _accuracy(result: Result, accuracy: Sequence[ReportFigure]) -> list[Block]:
    blocks: list[Block] = list(key_table(accuracy))
    residual = result.solver.get("largest_residual")
    if isinstance(residual, float):
        blocks.append(
            Facts([("Largest residual of the constraints after solving", f"{residual:.3g}")])
        )
    return blocks


def _solver(known: Mapping[str, Any]) -> list[tuple[str, str]]:
    rows = []
    for name, value in known.items():
        if name == "operations":
            rows.append(("Operations of the equations", _operations(str(value))))
            continue
        label = LABELS.get(name, words(name))
        unit = "s" if name.endswith(("_seconds", "_step")) else ""
        described = f"{value:.4g}" if isinstance(value, float) else str(value)
        described = ("no", "yes")[bool(value)] if name == "kernel_from_cache" else described
        rows.append((label, f"{described} {unit}".strip()))
    return rows


def _operations(text: str) -> str:
    try:
        counts = dict(json.loads(text))
    except (ValueError, TypeError):
        return text
    return ", ".join(f"{name} {count}" for name, count in counts.items())


def _parts(result: Result) -> Iterator[Block]:
    rows = [(s.get("part", ""), s.get("does", ""), s.get("source", "")) for s in result.sources]
    yield TextTable(("Part", "What it does", "Source"), rows)
    known = result.configuration
    units = known.get("units")
    flat = list(flattened(known, units if isinstance(units, dict) else {}))
    parameters = [row for row in flat if row[0].startswith("parameters.")]
    shorter = [(name.removeprefix("parameters."), value) for name, value in parameters]
    settings = [row for row in flat if row not in parameters]
    for title, kept in (("Parameters of the model", shorter), ("Settings", settings)):
        yield TextTable(("Name", "Value"), kept, (1,), f"{title} ({len(kept)})", closed=True)
    yield Facts([(words(name), str(version)) for name, version in result.versions.items()])


def flattened(value: Any, units: Mapping[str, str], place: str = "") -> Iterator[tuple[str, str]]:
    """Yield the numbers and texts of a nested configuration: dotted name, value with unit."""
    if isinstance(value, dict):
        for name, item in value.items():
            if place or name not in APART:
                yield from flattened(item, units, f"{place}.{name}" if place else str(name))
    elif value is not None and value not in ([], ""):
        items = value if isinstance(value, list) else [value]
        described = ", ".join(_described(item) for item in items)
        unit = str(units.get(place, "1"))
        yield place, f"{described} {unit_text(unit)}".rstrip()


def _described(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _channels(ranges: Sequence[ChannelRange]) -> TextTable:
    rows = [
        (
            channel.name,
            "–" if channel.smallest is None else number(channel.smallest),
            "–" if channel.largest is None else number(channel.largest),
            unit_text(channel.unit) or "–",
            channel.description + (f" (frame: {channel.frame})" if channel.frame else ""),
        )
        for channel in ranges
    ]
    head = ("Channel", "Smallest", "Largest", "Unit", "Meaning")
    return TextTable(head, rows, (1, 2), f"Channels ({len(rows)})", closed=True)


def _input(result: Result) -> Iterator[Block]:
    if result.scenario_text:
        yield Listing("Scenario", result.scenario_text)
    system = result.configuration.get("system")
    if system:
        yield Listing("System", str(system))
