"""Driving failures in a followed run, after which its figures say nothing of the manoeuvre."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.analyses.preparation.validity.bent_beams import BentBeams
from vehicledyn.analyses.simulation.lost_control import PATH_ERROR, lost_control
from vehicledyn.analyses.simulation.wanted_outputs import needed_channels
from vehicledyn.road.manoeuvres.channel_recorder import Recording

if TYPE_CHECKING:
    from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
    from vehicledyn.analyses.sensitivity.motion_study import MotionStudy


def driving_failure(study: MotionStudy, motion: MotionSlopes) -> str:
    """Return how the vehicle failed in a run, with time and place; empty if it did not.

    It overturned, derailed or lifted off, or its driver came too far from the path. An event that
    ends a run well is none.
    """
    e = study.prepared.equations
    outcome = {event.name: event.outcome for event in e.events}.get(motion.ended_by, "ok")
    if outcome != "ok":
        return f"{outcome}: event '{motion.ended_by}' ended the run at {motion.times[-1]:g} s"
    channels = [e.channels[k] for k in study.channels]
    if PATH_ERROR not in [channel.name for channel in channels]:
        return ""
    recording = Recording(
        motion.times,
        {channel.name: row for channel, row in zip(channels, motion.values.T, strict=True)},
        {channel.name: channel.unit for channel in channels},
    )
    return lost_control(study.prepared.subject.summarise(recording))


def driving_failure_of_run(study: MotionStudy) -> str:
    """Return the same of the run itself, for a study that follows few channels."""
    prepared = study.prepared
    if PATH_ERROR not in [channel.name for channel in prepared.equations.channels]:
        return ""
    whole = replace(study, channels=needed_channels(prepared))
    return driving_failure(whole, whole.plain(lambda *_: None))


def bent_beams(study: MotionStudy, motion: MotionSlopes) -> list[str]:
    """Return a warning for each beam that bent farther in a run than its modes hold for."""
    watch, columns = BentBeams.of(study.prepared), study.channels
    outputs = np.zeros((len(motion.times), len(study.prepared.equations.channels)))
    outputs[:, columns] = motion.values
    watch.take(motion.times, outputs)
    return watch.remarks()


def bent_beams_of(study: MotionStudy) -> list[str]:
    """Return the same of the run itself, for a study that follows few channels."""
    ends = [k for pair in BentBeams.of(study.prepared).watched.columns for k in pair]
    if not ends:
        return []
    whole = replace(study, channels=ends)
    return bent_beams(whole, whole.plain(lambda *_: None))
