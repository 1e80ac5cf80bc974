"""What NumPy, SciPy and other libraries warn of, in one sentence each instead of lines of code."""

from __future__ import annotations

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import ResultWarning
from vehicledyn.cli.exit_codes import NEGATIVE, OK, SOME_FAILED
from vehicledyn.cli.terminal import is_quiet, tell

_BEYOND = re.compile(r"(overflow|invalid value|divide by zero) encountered")
_MOST, _LONGEST = 5, 200


@contextmanager
def plain_foreign_warnings() -> Iterator[None]:
    """Collect warnings of the block, and tell them where it ends with a result.

    A refusal has its own words for what was wrong. What the program itself warns of is shown at
    once.
    """
    found: dict[str, None] = {}

    def take(message: Any, category: type[Warning], filename: str, *_: Any, **__: Any) -> None:
        if issubclass(category, ResultWarning):
            tell(str(message))
        elif not (issubclass(category, UserWarning) and _draws(filename)):
            found.setdefault(_sentence(str(message), filename))

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # of looks, too
    with warnings.catch_warnings():
        warnings.showwarning = take
        try:
            yield
        except SystemExit as end:
            if end.code in (None, OK, NEGATIVE, SOME_FAILED) and not is_quiet():
                for sentence in list(found)[:_MOST]:
                    tell(sentence)
            raise


def _sentence(message: str, filename: str) -> str:
    if _BEYOND.match(message):
        return (
            "warning: numbers left the range that a computer's numbers have; what depends on them "
            "may be no number; check the sizes of those given"
        )
    words = " ".join(message.split())
    shown = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"
    return f"warning of {_library(filename)}: {shown}"


def _draws(filename: str) -> bool:
    """Return whether a file is drawing; warnings of looks bear the caller's name."""
    return {"matplotlib", "results"} & set(Path(filename).parts) != set()


def _library(filename: str) -> str:
    """Return the package that a file of code belongs to.

    >>> _library("/usr/lib/python3/site-packages/scipy/linalg/_basic.py")
    'scipy'
    """
    parts = Path(filename).parts
    if "site-packages" in parts[:-1]:
        return parts[parts.index("site-packages") + 1].removesuffix(".py")
    return "vehicledyn" if "vehicledyn" in parts else Path(filename).stem
