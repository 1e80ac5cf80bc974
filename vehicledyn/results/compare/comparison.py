"""The outcome of a comparison: values, verdict, and its text, JSON and JUnit forms."""

from __future__ import annotations

import math
import re
from dataclasses import asdict, dataclass
from typing import Any
from xml.etree import ElementTree

EQUAL, DIFFERENT, UNUSABLE = "equal", "different", "unusable"

LISTED = 4  # names of channels in a note; the JSON lists all
_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_SHOWN = 20  # differing channels listed in the text; JSON and JUnit list all


@dataclass(frozen=True)
class ChannelComparison:
    """One channel of the reference and how far the result is from it.

    ``difference`` is the largest |result - reference|, ``tolerance`` what was allowed, both
    in the channel's unit; ``value`` and ``reference`` are those at ``time`` [s], where it
    occurs. They are None where nothing could be compared, and ``message`` says why; else it
    says where the difference occurs if that is no time.
    """

    name: str
    unit: str
    passed: bool
    difference: float | None = None
    tolerance: float | None = None
    value: float | None = None
    reference: float | None = None
    time: float | None = None
    message: str = ""

    @property
    def severity(self) -> float:
        """Difference as a multiple of the tolerance; infinite where none could be formed."""
        if self.difference is None or self.tolerance is None:
            return 0.0 if self.passed else math.inf
        if self.tolerance > 0.0:
            return self.difference / self.tolerance
        return math.inf if self.difference > 0.0 else 0.0


@dataclass(frozen=True, repr=False)
class Comparison:
    """Outcome of comparing a result with a reference.

    ``problems`` say why a file could not be used, ``differences`` what differs in the files
    as a whole (time, say); ``skipped`` are channels of the reference that the result lacks
    and that were allowed to lack, ``extra`` those that only the result has; ``notes`` inform.
    """

    result: str
    reference: str
    problems: tuple[str, ...] = ()
    differences: tuple[str, ...] = ()
    channels: tuple[ChannelComparison, ...] = ()
    skipped: tuple[str, ...] = ()
    extra: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def failed(self) -> tuple[ChannelComparison, ...]:
        """Channels that differ, worst first."""
        failed = [channel for channel in self.channels if not channel.passed]
        return tuple(sorted(failed, key=lambda channel: -channel.severity))

    @property
    def worst(self) -> ChannelComparison | None:
        """The channel with the largest difference relative to its tolerance."""
        return max(self.channels, key=lambda channel: channel.severity, default=None)

    @property
    def is_equal(self) -> bool:
        """Whether the result equals the reference within the tolerances."""
        return self.verdict == EQUAL

    def __bool__(self) -> bool:
        """Return the same, for ``assert compare(...)``."""
        return self.is_equal

    def __repr__(self) -> str:
        """Return the verdict and the worst channels in lines."""
        return self.as_text()

    @property
    def verdict(self) -> str:
        """One of "equal" (within tolerance), "different" and "unusable" (a file or an option)."""
        if self.problems:
            return UNUSABLE
        return DIFFERENT if self.differences or self.failed else EQUAL

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold."""
        worst = self.worst
        return {
            "verdict": self.verdict,
            **{key: _plain(value) for key, value in asdict(self).items()},
            "worst": None if worst is None else worst.name,
        }

    def as_text(self) -> str:
        """Return lines for a person: the verdict first, then the worst channels."""
        head = f"{self.verdict}: {self.result} against {self.reference}"
        lines = [head, *(f"  {text}" for text in (*self.problems, *self.differences))]
        if not self.problems:
            lines += [f"  {_sentence(channel)}" for channel in self.failed[:_SHOWN]]
            hidden = len(self.failed) - _SHOWN
            lines += [f"  and {hidden} more channels differ"] if hidden > 0 else []
            lines.append(self._count())
        lines += [f"  note: {text}" for text in self._all_notes()]
        return "\n".join(lines)

    def as_junit(self) -> str:
        """Return JUnit XML with one test case a channel and one for the files as a whole."""
        suite = ElementTree.Element("testsuite", name=_xml(f"compare {self.reference}"))
        whole = ElementTree.SubElement(
            suite, "testcase", classname="vehicledyn.compare", name="files"
        )
        for tag, texts in (("error", self.problems), ("failure", self.differences)):
            if texts:
                ElementTree.SubElement(whole, tag, message=_xml("; ".join(texts)))
        for channel in self.channels:
            case = ElementTree.SubElement(
                suite, "testcase", classname="vehicledyn.compare.channels", name=_xml(channel.name)
            )
            if not channel.passed:
                ElementTree.SubElement(case, "failure", message=_xml(_sentence(channel)))
        suite.set("tests", str(len(self.channels) + 1))
        suite.set("failures", str(len(self.failed) + bool(self.differences)))
        suite.set("errors", str(int(bool(self.problems))))
        suite.set("skipped", "0")
        suites = ElementTree.Element("testsuites")
        suites.append(suite)
        ElementTree.indent(suites)
        return ElementTree.tostring(suites, encoding="unicode", xml_declaration=True) + "\n"

    def _count(self) -> str:
        count = f"  {len(self.channels) - len(self.failed)} of {len(self.channels)} channels agree"
        worst = self.worst
        if worst is None or self.failed or worst.difference is None:
            return count
        return f"{count}; largest difference: {_sentence(worst)}"

    def _all_notes(self) -> list[str]:
        notes = list(self.notes)
        if self.skipped:
            notes.append(f"not in the result, skipped: {', '.join(self.skipped)}")
        if self.extra:
            notes.append(f"only in the result, not compared: {_few(self.extra)}")
        return notes


def _few(names: tuple[str, ...]) -> str:
    shown = ", ".join(names[:LISTED])
    return shown if len(names) <= LISTED else f"{shown} and {len(names) - LISTED} more"


def _sentence(channel: ChannelComparison) -> str:
    if channel.difference is None:
        return f"{channel.name}: {channel.message}"
    unit = "" if channel.unit in ("", "1") else f" {channel.unit}"
    where = channel.message or f"at t = {channel.time:.9g} s"
    return (
        f"{channel.name}: off by {channel.difference:.4g}{unit} "
        f"(allowed {channel.tolerance:.4g}) {where}: "
        f"{channel.value:.9g}, reference {channel.reference:.9g}"
    )


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _xml(text: str) -> str:
    return _NOT_IN_XML.sub("?", text)
