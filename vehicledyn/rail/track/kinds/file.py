"""Track in a file of its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field, ValidationError

from vehicledyn.base.parameters import read_part
from vehicledyn.base.problems import START, Problem, dotted, refusal
from vehicledyn.base.registry import register
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import words_of
from vehicledyn.base.yaml import read_yaml
from vehicledyn.rail.track.track import Track
from vehicledyn.rail.track.track_set import TrackChoice

if TYPE_CHECKING:
    from vehicledyn.rail.profiles.profile import Profile


@register("track", "file")
class TrackFile(TrackChoice):
    """Track that a YAML file describes: what stands under ``track`` elsewhere, kind and all."""

    names_files: ClassVar[bool] = True

    file: str = Field(description="The file, relative to the one that names it")

    def track(self, folder: Path) -> Track:
        """Return the track; files that it names are looked for beside its own."""
        path = folder / self.file
        return read_track(path).track(path.parent)

    def rail_profile(self, folder: Path) -> Profile:
        """Return the profile of its rails."""
        path = folder / self.file
        return read_track(path).rail_profile(path.parent)


def read_track(path: Path) -> TrackChoice:
    """Return the track that a YAML file describes.

    Raises
    ------
    InputError
        If it cannot be read or describes none; one line for each problem.
    """
    document = read_yaml(path)
    problems = list(document.problems)
    if not isinstance(document.data, dict):
        words = f"the file holds {describe(document.data)}; a track is a mapping with 'kind'"
        raise refusal([*problems, Problem(document.name, START, "file", words)], document.name)
    if document.data.get("kind") == TrackFile.kind:
        words = "a track's file cannot name another one; name that"
        raise refusal([Problem(document.name, START, "kind", words)], document.name)
    try:
        chosen = read_part("track", document.data)
    except ValidationError as error:
        for line in error.errors():
            place = line["loc"]
            mark = document.values.get(place) or document.keys.get(place[:-1], START)
            problems.append(Problem(document.name, mark, dotted(place), words_of(line)))
        raise refusal(problems, document.name) from None
    if problems or not isinstance(chosen, TrackChoice):
        raise refusal(problems, document.name)
    return chosen
