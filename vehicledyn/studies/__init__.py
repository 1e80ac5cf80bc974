"""Many runs of one scenario: what varies, who computes it, and the one file that keeps it."""

from vehicledyn.studies.load import LoadedStudy, is_study, load_study
from vehicledyn.studies.schema import study_schema
from vehicledyn.studies.sets import Study

__all__ = ["LoadedStudy", "Study", "is_study", "load_study", "study_schema"]
