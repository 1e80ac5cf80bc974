"""Animations of results: a page to move about in, a still picture, a film."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.results.animation.page import page_of
from vehicledyn.results.animation.scene import AnimatedScene, scene_of
from vehicledyn.results.hdf5.page_file import check_page, write_page
from vehicledyn.results.plots.table_results import holds_table
from vehicledyn.results.store.animation_section import Span
from vehicledyn.results.store.reader import ENDS, open_result
from vehicledyn.results.store.study_reader import is_study_file

PAGE, FILM = Span(3000), Span(20_000)
"""Pictures that a page holds and a film is made from, at most."""


@dataclass(frozen=True)
class AnimationFile:
    """A file written: its path, size in bytes, pictures in it, and remarks."""

    path: Path
    size: int
    pictures: int
    messages: tuple[str, ...] = ()


def animate_result(
    path: Path,
    target: Path,
    *,
    others: Sequence[Path] = (),
    channels: Sequence[str] = (),
    span: Span = PAGE,
) -> AnimationFile:
    """Write a page that plays a result, with other results laid over it.

    Parameters
    ----------
    path
        Result file, whole or partial.
    target
        HTML file to write.
    others
        Further results, shown in the same scene at the same times.
    channels
        Channels to plot beside, as shell patterns; those of the figures and others if empty.
    span
        Which pictures.

    Raises
    ------
    InputError
        If a file cannot be read or holds no shapes and poses, no channel matches a pattern, or the
        page cannot be written, such as over a file that is no animation.
    """
    check_page(target, "animation")
    scenes = read_scenes([path, *others], span=span, channels=channels)
    write_page(target, page_of(scenes))
    size = target.stat().st_size
    return AnimationFile(target, size, len(scenes[0].time), messages_of(scenes))


def picture_of_result(path: Path, target: Path, *, time: float | None, view: str) -> AnimationFile:
    """Draw a result at a time [s] (the middle if None) into a picture, see ``draw_picture``."""
    from vehicledyn.results.animation.still import draw_picture

    scenes = read_scenes([path], span=Span(PAGE.most, instant=time), plots=False)
    draw_picture(scenes[0], target, time=time, view=view)
    return AnimationFile(target, target.stat().st_size, 1, messages_of(scenes))


def film_of_result(
    path: Path,
    target: Path,
    *,
    view: str,
    rate: int,
    speed: float,
    progress: Callable[[str, float | None], None],
    span: Span = FILM,
) -> AnimationFile:
    """Draw a result into a film, see ``draw_film``."""
    from vehicledyn.results.animation.film import draw_film

    scenes = read_scenes([path], span=span, plots=False)
    pictures = draw_film(scenes[0], target, view=view, rate=rate, speed=speed, progress=progress)
    return AnimationFile(target, target.stat().st_size, pictures, messages_of(scenes))


def read_scenes(
    paths: Sequence[Path], *, span: Span = PAGE, channels: Sequence[str] = (), plots: bool = True
) -> list[AnimatedScene]:
    """Return what is drawn of some results; the channels asked for must be in the first."""
    scenes = []
    for index, path in enumerate(paths):
        _refuse_others(path)
        with open_result(path, ENDS) as result:
            wanted = channels if index == 0 else ()
            scenes.append(scene_of(result, span, patterns=wanted, plots=plots))
    return scenes


def _refuse_others(path: Path) -> None:
    """Raise an InputError for files of this program that hold no motion."""
    if is_study_file(path):
        raise InputError(
            f"{path}: holds the cases of a study, none of them in motion; run one of its cases "
            "with 'vehicledyn run' and animate that"
        )
    if holds_table(path):
        raise InputError(
            f"{path}: holds no motion but a table; draw it with 'vehicledyn plot', or animate the "
            "result of 'vehicledyn run'"
        )


def messages_of(scenes: Sequence[AnimatedScene]) -> tuple[str, ...]:
    """Return what is worth telling of some scenes: partial runs, values that are no numbers."""
    messages = []
    for scene in scenes:
        if not scene.is_whole:
            messages.append(f"{scene.label}: {scene.state}")
        if scene.bad_from is not None:
            messages.append(
                f"{scene.label}: poses from t = {scene.bad_from:.6g} s on are not all numbers; "
                "what is unknown is left out"
            )
    return tuple(messages)
