"""Report what was left out and bridged in the measured profiles that a run uses."""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.rail.profiles.profile import Profile
from vehicledyn.rail.track.track_set import TrackChoice

_REPORTED = ("left out: ", "bridged: ", "points scatter")


def mended_profiles(loaded: LoadedScenario) -> list[str]:
    """Return a sentence for each run of outliers left out and each gap bridged, by profile."""
    said = [
        f"{profile.source}: {note}"
        for profile in _profiles(loaded)
        for note in profile.notes
        if note.startswith(_REPORTED)
    ]
    return list(dict.fromkeys(said))


def _profiles(loaded: LoadedScenario) -> Iterator[Profile]:
    """Yield the profiles of the wheels and of the rails."""
    written = loaded.written
    if written.file is None or not written.file.rail_wheels:
        return
    for wheels in written.file.rail_wheels.values():
        yield wheels.open(written.path.parent)
    own, given = written.file.track, loaded.scenario.track
    if isinstance(given, TrackChoice):
        yield given.rail_profile(loaded.path.parent)
    elif isinstance(own, TrackChoice):
        yield own.rail_profile(written.path.parent)
