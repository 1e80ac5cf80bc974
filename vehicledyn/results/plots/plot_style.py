"""How figures look: size, colours that colour-blind readers can distinguish, fonts, labels.

References
----------
Okabe, Ito (2008), Color universal design: the palette, without its yellow, which is too
light for lines on white.
"""

from __future__ import annotations

from typing import Any

LONGEST_TEXT = 120  # characters of a title or label
WIDTH = 6.6  # inch, the text width of an A4 report
LEGEND_SIZE = 8.0  # points
BLUE, VERMILION, GREEN, ORANGE = "#0072B2", "#D55E00", "#009E73", "#E69F00"
BLACK = "#000000"
PALETTE = (BLUE, VERMILION, GREEN, "#CC79A7", ORANGE, "#56B4E9", BLACK)
LINE_STYLES = ("-", "--", "-.", ":")

STYLE: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": 9.0,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.dpi": 150.0,
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "grid.color": "0.88",
    "grid.linewidth": 0.6,
    "legend.borderaxespad": 0.1,
    "legend.fontsize": LEGEND_SIZE,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "lines.linewidth": 1.4,
    "savefig.dpi": 150.0,
    "svg.hashsalt": "vehicledyn",
    "text.parse_math": False,  # a dollar in a name or a title begins no formula
}

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plain(text: str, most: int = LONGEST_TEXT) -> str:
    """Return a text of a file for a picture: cut if it is long.

    >>> plain("a long description", most=7)
    'a long…'
    """
    known = text.encode("utf-8", "replace").decode("utf-8")
    return known if len(known) <= most else f"{known[: most - 1]}…"


def in_words(name: str, description: str) -> str:
    """Return how an axis names a quantity: its description, its name where it has none.

    >>> in_words("speed", "Speed"), in_words("wheelset.lateral_shift", "")
    ('Speed', 'Wheelset lateral shift')
    """
    return plain(description or name.replace("_", " ").replace(".", " ").capitalize())


def axis_label(quantity: str, unit: str) -> str:
    """Return the label of an axis: quantity and unit.

    >>> axis_label("Lateral acceleration", "m/s^2")
    'Lateral acceleration [m/s²]'
    """
    head, *powers = unit.split("^")
    shown = head
    for power in powers:
        digits = power[: len(power) - len(power.lstrip("-0123456789"))]
        shown += digits.translate(SUPERSCRIPTS) + power[len(digits) :]
    return plain(f"{quantity} [{'–' if unit in ('', '1') else shown}]")
