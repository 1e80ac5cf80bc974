"""What every analysis can say about its result."""

from __future__ import annotations

from typing import Any, Protocol


class Report(Protocol):
    """A result as text for people and as plain data for programs."""

    def as_text(self) -> str:
        """Return the report as lines of text."""

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain data."""
