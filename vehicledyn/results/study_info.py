"""What the file of a study holds, for people and for programs."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.units import shown
from vehicledyn.results.store.study_reader import StudyFile, open_study

_MOST_FAILURES = 20


@dataclass(frozen=True)
class ValueRange:
    """Smallest, mean and largest of some values in SI; None where there are none."""

    name: str
    unit: str
    description: str
    count: int
    smallest: float | None
    mean: float | None
    largest: float | None

    @property
    def text(self) -> str:
        """The three values as a person reads them."""
        if self.smallest is None or self.mean is None or self.largest is None:
            return "none"
        low, mean, high = (shown(v, self.unit) for v in (self.smallest, self.mean, self.largest))
        return f"{low} to {high}, mean {mean}"


@dataclass(frozen=True)
class StudyDescription:
    """What the file of a study holds."""

    path: str
    title: str
    status: str
    state: str
    created: str
    program_version: str
    cases: dict[str, int]
    axes: tuple[ValueRange, ...]
    choices: dict[str, tuple[str, ...]]
    figures: tuple[ValueRange, ...]
    texts: dict[str, dict[str, int]]
    channels: tuple[str, ...]
    samples: int
    failures: tuple[tuple[int, float, str], ...]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold."""
        return asdict(self)

    def as_text(self) -> str:
        """Return lines for a person; a partial file says so first."""
        listed = ", ".join(f"{number} {name}" for name, number in self.cases.items() if number)
        lines = [] if self.state == "whole" else [f"PARTIAL STUDY: {self.state[9:]}", ""]
        lines += [
            f"{self.path}: {self.title}",
            f"  status    {self.status}",
            f"  cases     {listed}",
            f"  holds     {len(self.channels)} channels of {self.samples} samples a case",
            f"  created   {self.created} by vehicledyn {self.program_version}",
        ]
        width = max([len(s.name) for s in (*self.axes, *self.figures)], default=0)
        lines += _table("Varied", [(s.name, s.text) for s in self.axes], width)
        lines += _table("Choices", [(k, ", ".join(v)) for k, v in self.choices.items()], width)
        lines += _table("Key figures", [(s.name, s.text) for s in self.figures], width)
        told_texts = [
            (name, ", ".join(f"{text} {number} times" for text, number in counts.items()))
            for name, counts in self.texts.items()
        ]
        lines += _table("Key figures that are texts", told_texts, width)
        failures = [(f"case {case}", reason) for case, _, reason in self.failures]
        return "\n".join([*lines, *_table("Failed cases", failures, 0)])


def describe_study(path: Path) -> StudyDescription:
    """Return what the file of a study holds.

    Raises
    ------
    InputError
        If it cannot be read or is none.
    """
    with open_study(path) as file:
        spreads, choices = _axes(file)
        figures, texts = _figures(file)
        return StudyDescription(
            path=str(path),
            title=file.title,
            status=file.status,
            state=file.state,
            created=file.created,
            program_version=file.program_version,
            cases=file.counts(),
            axes=spreads,
            choices=choices,
            figures=figures,
            texts=texts,
            channels=tuple(channel.name for channel in file.channels),
            samples=len(file.times),
            failures=tuple(file.reasons(_MOST_FAILURES)),
        )


def _axes(file: StudyFile) -> tuple[tuple[ValueRange, ...], dict[str, tuple[str, ...]]]:
    spreads, choices = [], {}
    for column, axis in enumerate(file.axes):
        if axis.choices:
            choices[axis.name] = axis.choices
        else:
            spreads.append(_spread(axis.name, axis.unit, "", file.axis(column)))
    return tuple(spreads), choices


def _figures(file: StudyFile) -> tuple[tuple[ValueRange, ...], dict[str, dict[str, int]]]:
    spreads, texts = [], {}
    for name, figure in file.figures.items():
        spread = _spread(name, figure.unit, figure.description, file.figure(name))
        if spread.count:
            spreads.append(spread)
        else:
            texts[name] = _counted(file.figure_texts(name))
    return tuple(spreads), texts


def _counted(texts: list[str]) -> dict[str, int]:
    known = [text for text in texts if text]
    return {text: known.count(text) for text in sorted(set(known))}


def _spread(name: str, unit: str, description: str, values: Any) -> ValueRange:
    known = values[np.isfinite(values)]
    if not known.size:
        return ValueRange(name, unit, description, 0, None, None, None)
    low, mean, high = float(known.min()), float(known.mean()), float(known.max())
    return ValueRange(name, unit, description, int(known.size), low, mean, high)


def _table(title: str, rows: list[tuple[str, str]], width: int) -> list[str]:
    if not rows:
        return []
    size = max(width, *(len(name) for name, _ in rows))
    return ["", title, *(f"  {name:{size}}  {text}" for name, text in rows)]
