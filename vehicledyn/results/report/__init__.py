"""Reports: one self-contained page of a result, of two compared, or of a folder of results."""

from __future__ import annotations

from vehicledyn.results.report.folder import results_in
from vehicledyn.results.report.write import write_report

__all__ = ["results_in", "write_report"]
