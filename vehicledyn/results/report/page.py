"""What a page holds, as plain values, and the page as HTML.

A page is sections of blocks; the template page.html shows each block by its kind. All text is
escaped there, and the page forbids browsers to run or fetch anything: what files say is shown,
never executed.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from vehicledyn.base.version import VERSION

LONGEST_CELL = 2000
MOST_ROWS = 2000


@dataclass(frozen=True)
class Facts:
    """Names and what they are."""

    kind: ClassVar[str] = "facts"
    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class TextTable:
    """Rows of texts under a head; ``numbers`` are the columns set to the right."""

    kind: ClassVar[str] = "table"
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: Sequence[int] = ()
    caption: str = ""
    closed: bool = False


@dataclass(frozen=True)
class Picture:
    """A picture as a data address, its size in pixels, and its text alternative."""

    kind: ClassVar[str] = "picture"
    address: str
    width: int
    height: int
    alternative: str
    caption: str = ""


@dataclass(frozen=True)
class PictureRow:
    """Pictures beside each other where there is room; ``paired`` if they belong in pairs."""

    kind: ClassVar[str] = "pictures"
    items: Sequence[Picture]
    paired: bool = False


@dataclass(frozen=True)
class Notes:
    """Sentences, as a list."""

    kind: ClassVar[str] = "notes"
    texts: Sequence[str]
    warning: bool = False


@dataclass(frozen=True)
class Listing:
    """A text to be shown as it is, folded under its title, open if it has none."""

    kind: ClassVar[str] = "listing"
    title: str
    text: str


@dataclass(frozen=True)
class FileLink:
    """A link to a file beside the page; ``address`` is relative and quoted."""

    kind: ClassVar[str] = "link"
    address: str
    text: str


Block = Facts | TextTable | PictureRow | Notes | Listing | FileLink


@dataclass(frozen=True)
class Section:
    """A part of the page with a title."""

    title: str
    blocks: Sequence[Block]

    @property
    def anchor(self) -> str:
        """Its name within the page."""
        return "-".join("".join(c if c.isalnum() else " " for c in self.title.lower()).split())


@dataclass(frozen=True)
class Page:
    """A whole page; ``state`` is empty where the result is complete."""

    title: str
    subtitle: str
    sections: Sequence[Section]
    state: str = ""
    links: Sequence[FileLink] = field(default_factory=tuple)


def render(page: Page) -> str:
    """Return a page as HTML that needs nothing but itself.

    Raises
    ------
    MissingPartError
        If jinja2 is not installed.
    """
    from vehicledyn.base.errors import MissingPartError

    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError:
        raise MissingPartError("reports need jinja2: pip install jinja2") from None

    environment = Environment(
        loader=PackageLoader("vehicledyn.results.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["readable"] = readable
    template = environment.get_template("page.html")
    style, _, _ = environment.loader.get_source(environment, "page.css")  # type: ignore[union-attr]
    return template.render(
        page=page,
        style=style,
        version=VERSION,
        most_rows=MOST_ROWS,
    )


def readable(text: object, most: int = LONGEST_CELL) -> str:
    """Return a text without signs that have no picture, and cut where it is too long."""
    words = str(text)
    shown = "".join(c if c in "\n\t" or _is_shown(c) else "�" for c in words[:most])
    return shown if len(words) <= most else f"{shown} … ({len(words)} signs in all)"


def _is_shown(sign: str) -> bool:
    # Cc: control, Cs: lone surrogates; Cf turns the direction of writing, and joins emoji.
    kind = unicodedata.category(sign)
    return kind not in ("Cc", "Cs") and (kind != "Cf" or sign in "\u200c\u200d")
