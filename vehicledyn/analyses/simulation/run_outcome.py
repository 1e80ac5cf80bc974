"""What a run returns: its file, how it ended and its key figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown
from vehicledyn.results.store.layout import SummaryEntry


@dataclass(frozen=True)
class ShownEntry:
    """A line of the summary: value in SI, unit, and the text a person reads."""

    value: float | int | bool | str
    unit: str
    text: str


@dataclass(frozen=True)
class RunOutcome:
    """Outcome of a run: the result file, how it ended, key figures, messages."""

    path: Path
    status: str
    summary: dict[str, ShownEntry]
    messages: list[str]

    def as_text(self) -> str:
        """Return status and key figures as lines."""
        width = max(map(len, self.summary), default=0)
        lines = [f"  {name:{width}}  {entry.text}" for name, entry in self.summary.items()]
        return "\n".join([f"{self.path}: {self.status}", *lines])

    def as_dict(self) -> dict[str, Any]:
        """Return status, key figures and messages as plain data."""
        return {
            "result": self.path,
            "status": self.status,
            "summary": {name: asdict(entry) for name, entry in self.summary.items()},
            "messages": self.messages,
        }


def shown_entry(entry: SummaryEntry, width: int) -> ShownEntry:
    """Return an entry as a person reads it, its value padded to `width` characters."""
    text = shown(entry.value, entry.unit)
    return ShownEntry(entry.value, entry.unit, f"{text:<{width}} {entry.description}")


def kernel_message(prepared: Prepared) -> str:
    """Return what a run says of the kernel it uses."""
    report = prepared.kernel.report
    total = report.operations.get("rates", 0)
    origin = "cached" if report.cached else f"built in {_built(prepared):.1f} s"
    return f"kernel: {prepared.kernel.description}, {total} operations a right-hand side, {origin}"


def _built(prepared: Prepared) -> float:
    report = prepared.kernel.report
    return report.generation_seconds + report.compilation_seconds
