"""All kinds of parts of system files, loaded only when a system file is read."""

from pathlib import Path

from vehicledyn.base.registry import discover


def load_kinds() -> None:
    """Import every module of this package, so that all kinds of parts are registered.

    Only what needs them does so: runs of the vehicles of the catalogue start quicker without.
    """
    discover("vehicledyn.files.system", [str(Path(__file__).parent)])
