"""How far the channels of two runs are apart, for the page that compares them."""

from __future__ import annotations

from vehicledyn.results.compare.comparison import ChannelComparison
from vehicledyn.results.compare.run_compare import compare_files
from vehicledyn.results.report.content import Content
from vehicledyn.results.report.page import Notes, Section, TextTable
from vehicledyn.results.report.texts import reading
from vehicledyn.results.store.reader import ENDS, open_result

MOST_CHANNELS = 20
MOST_SAMPLES = 1_000_000
"""Samples of a run up to which channels are compared one by one."""


def differences(first: Content, second: Content, names: tuple[str, str]) -> list[Section]:
    """Return the section on the channels that differ most, of runs only."""
    if first.what not in ("Simulation", "Kinematics"):
        return []
    for content in (first, second):
        with open_result(content.path, ENDS) as result:
            if result.samples > MOST_SAMPLES:
                text = (
                    f"{result.samples} samples are too many to compare here; use the verb compare."
                )
                return [Section("Channels", [Notes([text])])]
    found = compare_files(first.path, second.path, allow_missing=True, interpolate=True)
    lines = [*found.problems, *found.differences, *found.notes]
    if found.skipped:
        lines.append(f"only in {names[1]}: {', '.join(found.skipped[:MOST_CHANNELS])}")
    if found.extra:
        lines.append(f"only in {names[0]}: {', '.join(found.extra[:MOST_CHANNELS])}")
    apart = [c for c in found.channels if c.difference is not None and c.severity > 0.0]
    leading = sorted(apart, key=lambda c: -_share(c))[:MOST_CHANNELS]
    rows = [
        (
            c.name,
            reading(c.value, c.unit),
            reading(c.reference, c.unit),
            f"{100.0 * _share(c):.3g} %",
            reading(c.time, "s"),
        )
        for c in leading
    ]
    blocks: list[Notes | TextTable] = [Notes(lines)] if lines else []
    if rows:
        head = ("Channel", *names, "Of the range", "At")
        caption = "The channels that differ most, in parts of their range, where they do most."
        blocks.append(TextTable(head, rows, (1, 2, 3, 4), caption))
    elif not found.problems and not found.differences:
        blocks.append(Notes([f"All {len(found.channels)} channels are equal."]))
    return [Section("Channels", blocks)]


def _share(channel: ChannelComparison) -> float:
    """Return the difference in parts of the reference's range, from the tolerance of 1e-6."""
    return 1e-6 * channel.severity
