"""All kinds of parts of system files, loaded only when a system file is read."""

from functools import cache
from pathlib import Path

import vehicledyn.multibody.elements
import vehicledyn.multibody.joints  # noqa: F401
from vehicledyn.base.registry import discover
from vehicledyn.files.system.declared_sets import announce_elements
from vehicledyn.files.system.joint_sets import announce_joints


def load_kinds() -> None:
    """Enter what the modules of this package register, joints and elements of the catalogues.

    Only what needs them does so: runs of the vehicles of the catalogue start quicker without.
    """
    _enter_own()
    announce_joints()
    announce_elements()


@cache
def _enter_own() -> None:
    """Read the modules of this package once; who adds kinds of their own registers them."""
    discover("vehicledyn.files.system", [str(Path(__file__).parent)])
