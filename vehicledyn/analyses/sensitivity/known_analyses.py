"""Analyses whose figures have derivatives: how their names look, and what finds them.

A new analysis is a new entry here. What finds derivatives takes a scenario, target or file, names
of figures, patterns of parameters, a speed where the analysis has one, and ``progress``, and by
name the memory of steps; it is loaded when it is asked for.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from vehicledyn.analyses.sensitivity import figure_kinds

if TYPE_CHECKING:
    from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Finder: TypeAlias = "Callable[..., SensitivityTable]"
"""Returns derivatives."""

Loaded: TypeAlias = tuple[Finder, tuple[type, ...]]
"""What finds derivatives, and the classes among the results of its steps."""


@dataclass(frozen=True)
class Analysis:
    """An analysis whose figures have derivatives.

    ``owns`` says whether a name is that of one of its figures. ``has_speed`` says whether it
    takes a speed of its own, ``subject`` what it is of: a model or scenario, a scenario alone, or
    a file of its own; ``is_slow`` whether it takes longer than a check of names may.
    """

    owns: Callable[[str], bool]
    load: Callable[[], Loaded]
    has_speed: bool = False
    subject: Literal["target", "scenario", "file"] = "target"
    is_slow: bool = False


def _linear() -> Loaded:
    from vehicledyn.analyses.sensitivity import linear

    return linear.find_linear_sensitivity, linear.KINDS


def _response() -> Loaded:
    from vehicledyn.analyses.sensitivity.responses import find_response_sensitivity

    return find_response_sensitivity, ()


def _cycle() -> Loaded:
    from vehicledyn.analyses.sensitivity import cycles

    return cycles.find_cycle_sensitivity, cycles.KINDS


def _kinematic() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects import kinematic_curves

    return kinematic_curves.find_kinematic_sensitivity, kinematic_curves.KINDS


def _inverse() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects.inverse_forces import find_inverse_sensitivity

    return find_inverse_sensitivity, ()


def _rig() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects.rig_figures import find_rig_sensitivity

    return find_rig_sensitivity, ()


def _steady() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects import steady_figures

    return steady_figures.find_steady_sensitivity, steady_figures.KINDS


def _tyre() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects.tyre_figures import find_tyre_sensitivity

    return find_tyre_sensitivity, ()


def _profiles() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects.contact_figures import find_contact_sensitivity

    return find_contact_sensitivity, ()


def _cam() -> Loaded:
    from vehicledyn.analyses.sensitivity.subjects.cam_figures import find_cam_sensitivity

    return find_cam_sensitivity, ()


def _run() -> Loaded:
    from vehicledyn.analyses.sensitivity import motion, motion_study

    return motion.find_motion_sensitivity, motion_study.KINDS


def _called(name: str) -> Callable[[str], bool]:
    """Return what recognises names such as ``inverse(...)``."""
    form = re.compile(rf"{name}\(.*\)")
    return lambda text: form.fullmatch(text) is not None


RUN = "run"
ANALYSES = {
    "linear": Analysis(figure_kinds.is_linear, _linear, has_speed=True),
    "response": Analysis(figure_kinds.is_response, _response, has_speed=True),
    "cycle": Analysis(figure_kinds.is_cycle, _cycle, has_speed=True, is_slow=True),
    "kinematics": Analysis(_called("kinematics"), _kinematic),
    "inverse": Analysis(_called("inverse"), _inverse, subject="scenario"),
    "rig": Analysis(_called("rig"), _rig),
    "steady": Analysis(_called("steady"), _steady),
    "tyre": Analysis(_called("tyre"), _tyre, subject="file"),
    "profiles": Analysis(_called("profiles"), _profiles, subject="file"),
    "cam": Analysis(_called("cam"), _cam, subject="file"),
    RUN: Analysis(lambda _: True, _run, subject="scenario"),
}
"""Analyses by name; a figure belongs to the first that owns its name."""


def analysis_of(name: str) -> str:
    """Return the name of the analysis that a figure belongs to.

    >>> analysis_of("inverse(crank.angle_force)"), analysis_of("max(chassis.roll)")
    ('inverse', 'run')
    """
    return next(kind for kind, analysis in ANALYSES.items() if analysis.owns(name))
