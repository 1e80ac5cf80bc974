"""Systems written in YAML alone: read, validate, expand, build, write back."""

from vehicledyn.base.registry import discover
from vehicledyn.files.system import files as files


def load_kinds() -> None:
    """Import every module here, so that all kinds of parts of system files are registered.

    Only what needs them does so: runs of the vehicles of the catalogue start quicker without.
    """
    discover(__name__, __path__)
