"""A cam in a file of its own: what it is, what it moves, and how finely it is shown."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field, ValidationError

import vehicledyn.cams.followers
import vehicledyn.cams.laws
import vehicledyn.cams.outlines  # noqa: F401
from vehicledyn.base.problems import START, Problem, refusal
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import UNKNOWN_KEY, words_of
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.cams.cam import Cam
from vehicledyn.cams.checks import checked
from vehicledyn.cams.forces import CamLoad
from vehicledyn.cams.places import problem_at


class CamFile(Cam):
    """A cam with its title and what it moves."""

    title: str = Field(description="What it is, in a sentence")
    load: CamLoad | None = Field(default=None, description="What it moves, for forces")
    steps: int = Field(default=720, ge=8, le=100_000, description="Lines of the table over a turn")


def read_cam(path: Path) -> CamFile:
    """Return the cam of a file, its tables read, checked as a whole.

    Raises
    ------
    InputError
        If anything is wrong, with a line for each problem.
    """
    return cam_of(read_yaml(path), path.parent)


def cam_of(document: Document, folder: Path) -> CamFile:
    """Return the cam of a document that was read; files are relative to a folder.

    Raises
    ------
    InputError
        As :func:`read_cam`.
    """
    problems = list(document.problems)
    if not isinstance(document.data, dict):
        words = f"the file holds {describe(document.data)}; a cam is a mapping"
        raise refusal([*problems, Problem(document.name, START, "file", words)], document.name)
    try:
        cam = CamFile.model_validate(document.data)
    except ValidationError as error:
        problems += [
            problem_at(document, line["loc"], words_of(line), at_key=line["type"] == UNKNOWN_KEY)
            for line in error.errors()
        ]
        raise refusal(problems, document.name) from None
    whole, faults = checked(cam, folder)
    problems += [problem_at(document, fault.place, fault.words) for fault in faults]
    if problems or not isinstance(whole, CamFile):
        raise refusal(problems, document.name)
    return whole
