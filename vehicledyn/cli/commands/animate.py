"""The verb that shows results in motion."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.cli.options import Json, Quiet, ResultFile
from vehicledyn.cli.terminal import emit, show_progress, tell, to_json

_OTHER_ENDINGS = {
    **dict.fromkeys((".png", ".svg", ".pdf"), "--picture"),
    **dict.fromkeys((".gif", ".mp4"), "--film"),
}


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(animate)


def animate(
    result: ResultFile,
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Page to write; RESULT_animation.html if absent."),
    ] = None,
    others: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="RESULT", help="Show this result too; may be repeated."),
    ] = None,
    channels: Annotated[
        list[str] | None,
        typer.Option("--channel", metavar="PATTERN", help="Offer only these channels for plots."),
    ] = None,
    begin: Annotated[
        str | None, typer.Option("--from", metavar="TIME", help="Start time of page and film.")
    ] = None,
    end: Annotated[
        str | None, typer.Option("--to", metavar="TIME", help="End time of page and film.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Save one picture to this png, svg or pdf file.")
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="TIME", help="Time of the picture; mid-run if absent.")
    ] = None,
    film: Annotated[Path | None, typer.Option(help="Save a film to this gif or mp4 file.")] = None,
    rate: Annotated[int, typer.Option(min=1, max=100, help="Frames per second of the film.")] = 15,
    speed: Annotated[
        float,
        typer.Option(
            min=1e-4, max=1e4, help="Playback speed: simulated seconds per second of film."
        ),
    ] = 1.0,
    view: Annotated[
        str, typer.Option(help="Camera of picture and film: angle, side, front or top.")
    ] = "angle",
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Animate a result: a page for the browser, a picture or a film."""
    moment = None if at is None else _time("--at", at)
    first = -math.inf if begin is None else _time("--from", begin)
    last = math.inf if end is None else _time("--to", end)
    if first > last:
        raise InputError(f"--from {begin}: lies behind --to {end}")
    ending = "" if output is None else output.suffix.lower()
    if ending in _OTHER_ENDINGS:
        option = _OTHER_ENDINGS[ending]
        raise InputError(f"--output {output}: is a page for the browser; give {option} {output}")
    from vehicledyn.results.animation.animate import (
        FILM,
        PAGE,
        animate_result,
        film_of_result,
        picture_of_result,
    )

    written = []
    if picture is not None:
        written.append(picture_of_result(result, picture, time=moment, view=view))
    elif at is not None:
        raise InputError("--at: is the time of a picture; give --picture FILE too")
    if film is not None:
        with show_progress(quiet=quiet) as progress:
            written.append(
                film_of_result(
                    result,
                    film,
                    view=view,
                    rate=rate,
                    speed=speed,
                    progress=progress,
                    span=replace(FILM, begin=first, end=last),
                )
            )
    if output is not None or not written:
        page = output or result.parent / f"{result.stem}_animation.html"
        written.append(
            animate_result(
                result,
                page,
                others=others or (),
                channels=channels or (),
                span=replace(PAGE, begin=first, end=last),
            )
        )
    for message in dict.fromkeys(text for file in written for text in file.messages):
        tell(message)
    if as_json:
        facts = [{"file": f.path, "bytes": f.size, "pictures": f.pictures} for f in written]
        emit(to_json(facts))
    else:
        for file in written:
            emit(str(file.path))


def _time(option: str, text: str) -> float:
    try:
        return to_si(text, "s")
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
