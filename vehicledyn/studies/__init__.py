"""Many runs of one scenario: what varies, who computes it, and the one file that keeps it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vehicledyn.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from vehicledyn.studies.load import LoadedStudy, load_study
    from vehicledyn.studies.schema import study_schema
    from vehicledyn.studies.sets import Study

__all__ = ["LoadedStudy", "Study", "is_study", "load_study", "study_schema"]

# Most files are no studies: what reads them is loaded for those that are.
__getattr__ = lazy_exports(
    __name__,
    {
        "vehicledyn.studies.load": ("LoadedStudy", "load_study"),
        "vehicledyn.studies.schema": ("study_schema",),
        "vehicledyn.studies.sets": ("Study",),
    },
)


def is_study(data: Any) -> bool:
    """Return whether a file's data is a study."""
    return isinstance(data, dict) and "scenario" in data and "model" not in data
