"""What a page shows of a study: distributions, sensitivities, cases that failed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vehicledyn.results.plots.studies.study_plots import rank_correlation, study_figures
from vehicledyn.results.report.content import Content, Figures, ReportFigure, words
from vehicledyn.results.report.page import Block, Listing, Section, TextTable
from vehicledyn.results.report.texts import moment, reading
from vehicledyn.results.store.study_reader import StudyFile, open_study
from vehicledyn.results.study_info import StudyDescription, ValueRange, describe_study

LEADING = 3
WEAK = 0.1
"""Rank correlations below this are not shown."""


def study_content(path: Path) -> Content:
    """Return what a page shows of the file of a study."""
    known = describe_study(path)
    listed = ", ".join(f"{count} {name}" for name, count in known.cases.items() if count)
    return Content(
        path=path,
        what="Study",
        title=known.title,
        state="" if known.state == "whole" else known.state,
        facts=[
            ("Cases", listed or "none"),
            ("Channels", f"{len(known.channels)}, {known.samples} samples a case"),
            ("Status", known.status),
            ("Computed", f"{moment(known.created)} by vehicledyn {known.program_version}"),
        ],
        key_figures=[
            ReportFigure(
                f"{s.name}.mean", s.mean, s.unit, f"{s.description or words(s.name)}, mean"
            )
            for s in known.figures
            if s.mean is not None
        ],
        figures=lambda: _figures(path),
        details=lambda: _details(path, known),
        warnings=lambda: _warnings(known),
    )


def _warnings(known: StudyDescription) -> list[str]:
    failed = known.cases.get("failed", 0)
    return [f"{failed} cases failed; they are left out of all figures."] if failed else []


def _figures(path: Path) -> Figures:
    with open_study(path) as file:
        yield from study_figures(file)


def _details(path: Path, known: StudyDescription) -> list[Section]:
    with open_study(path) as file:
        effects = list(_effects(file))
        texts: list[Block] = [Listing("Study", file.text("study"))]
        texts.append(Listing("Scenario", file.text("scenario")))
        settings = json.dumps(file.configuration, indent=2, ensure_ascii=False)
        texts.append(Listing("Configuration", settings))
    head = ("Quantity", "Cases", "Smallest", "Mean", "Largest")
    varied = [(spread.name, *_row(spread)[1:]) for spread in known.axes]
    choices = [(name, ", ".join(values)) for name, values in known.choices.items()]
    counted = [
        (name, ", ".join(f"{text} {number} times" for text, number in counts.items()))
        for name, counts in known.texts.items()
    ]
    failures = [(f"{case}", reading(time, "s"), reason) for case, time, reason in known.failures]
    tables = {
        "Key figures of all cases": [
            TextTable(head, [_row(s) for s in known.figures], (1, 2, 3, 4)),
            TextTable(("Key figure", "Texts"), counted),
        ],
        "Sensitivities": [
            TextTable(
                ("Key figure", "Rank correlation with"),
                effects,
                caption=f"The {LEADING} leading effects of what was varied, from -1 to 1.",
            )
        ],
        "What was varied": [
            TextTable(head, varied, (1, 2, 3, 4)),
            TextTable(("Choice", "Values"), choices),
        ],
        "Failed cases": [TextTable(("Case", "Time", "Reason"), failures)],
    }
    kept = {title: [t for t in found if t.rows] for title, found in tables.items()}
    sections = [Section(title, found) for title, found in kept.items() if found]
    return [*sections, Section("Input", texts)]


def _row(spread: ValueRange) -> tuple[str, ...]:
    values = (spread.smallest, spread.mean, spread.largest)
    listed = ("–" if value is None else reading(value, spread.unit) for value in values)
    return (spread.description or words(spread.name), str(spread.count), *listed)


def _effects(file: StudyFile) -> Iterator[tuple[str, str]]:
    """Yield every key figure with what it follows most."""
    columns = {a.name: file.axis(k) for k, a in enumerate(file.axes) if not a.choices}
    for name, figure in file.figures.items():
        values = file.figure(name)
        if not np.isfinite(values).any():
            continue
        found = [(rank_correlation(values, column), axis) for axis, column in columns.items()]
        strong = sorted((f for f in found if abs(f[0]) >= WEAK), key=lambda f: -abs(f[0]))
        listed = ", ".join(f"{axis} {share:+.2f}" for share, axis in strong[:LEADING])
        if listed:
            yield figure.description or words(name), listed
