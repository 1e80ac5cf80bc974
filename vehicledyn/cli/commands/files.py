"""Verbs on result files: compare, plot, info, assess."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.cli.completion import channel_names, figure_names
from vehicledyn.cli.exit_codes import CODES_OF_VERDICTS
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import Format, Json, ResultFile, tolerance_of_channels
from vehicledyn.cli.terminal import emit, emit_report, to_json, write_text

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedScenario


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    for verb in (compare, plot, info, assess):
        app.command()(verb)


def read_scenario(path: Path, overrides: list[str] | None) -> LoadedScenario:
    """Return the scenario of a path or name, read with all catalogues present."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.files.scenario import load_scenario

    return load_scenario(find_file(path, "scenario"), overrides or ())


def read_file(path: Path, overrides: list[str] | None) -> list[str]:
    """Read a scenario, system or study file; return what is to be known of it.

    Raises
    ------
    InputError
        If something is wrong with it.
    """
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.yaml import read_yaml, remembered_files

    path = find_file(path, "scenario", "study", "system")
    with remembered_files({}):
        return _read_as(read_yaml(path).data, path, overrides or [])


def _read_as(data: Any, path: Path, overrides: list[str]) -> list[str]:
    """Read a file as files of its kind are read, and return warnings of its roads and paths."""
    from vehicledyn.analyses.simulation.cautions import cautions
    from vehicledyn.files.scenario import is_system_file, load_model, load_scenario
    from vehicledyn.studies import is_study

    if load := _parameter_study(data):
        return cautions(*load(path, overrides).subjects())
    if is_study(data):
        from vehicledyn.studies import load_study

        return cautions(*load_study(path, overrides).subjects())
    if _is_track(data):
        from vehicledyn.rail.track.kinds.file import read_track

        chosen = read_track(path)
        chosen.track(path.parent)
        wrong = chosen.problems_beside(path.parent)
        if wrong:
            raise InputError("\n".join(wrong))
    elif _is_cam(data):
        from vehicledyn.cams.cam_file import read_cam

        read_cam(path)
    elif is_system_file(path):
        return cautions(load_model(str(path), overrides))
    else:
        loaded = load_scenario(path, overrides)
        if loaded.asks_for_outputs:
            from vehicledyn.analyses.simulation.wanted_outputs import validate_outputs

            validate_outputs(loaded)
        return cautions(loaded)
    return []


def _parameter_study(data: Any) -> Callable[[Path, list[str]], Any] | None:
    """Return what reads a study of parameters, by the key that only its kind has."""
    keys = set(data) if isinstance(data, dict) else set()
    if "model" in keys and "controls" not in keys:
        return None
    if {"minimise", "controls"} <= keys:
        from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre

        return load_manoeuvre
    if keys & {"minimise", "least_squares"}:
        from vehicledyn.studies.optimisation.file import load_optimisation

        return load_optimisation
    if "experiments" in keys:
        from vehicledyn.studies.identification.study import load_identification

        return load_identification
    if {"scenario", "of"} <= keys:
        from vehicledyn.studies.uncertainty.study import load_uncertainty

        return load_uncertainty
    return None


def _is_track(data: Any) -> bool:
    """Return whether a file's data is a track, not a scenario or system."""
    from vehicledyn.base.registry import kinds

    return isinstance(data, dict) and data.get("kind") in kinds("track") and "title" not in data


def _is_cam(data: Any) -> bool:
    """Return whether a file's data is a cam, not a scenario or system."""
    keys = set(data) if isinstance(data, dict) else set()
    return bool(keys & {"base_radius", "outline", "follower"}) and not keys & {"model", "bodies"}


def compare(
    result: ResultFile,
    reference: Annotated[Path, typer.Argument(metavar="REFERENCE", help="Reference result.")],
    *,
    relative: Annotated[
        float, typer.Option(min=0.0, help="Tolerance relative to the reference's range.")
    ] = 1e-6,
    absolute: Annotated[
        float, typer.Option(min=0.0, help="Absolute tolerance in SI units, added to it.")
    ] = 1e-12,
    tolerances: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance", metavar="PATTERN=VALUE", help="Relative tolerance of some channels."
        ),
    ] = None,
    channels: Annotated[
        list[str] | None,
        typer.Option(
            "--channel",
            metavar="PATTERN",
            help="Compare only these channels.",
            autocompletion=channel_names,
        ),
    ] = None,
    allow_missing: Annotated[
        bool, typer.Option("--allow-missing", help="Allow channels to be missing from the result.")
    ] = False,
    interpolate: Annotated[
        bool, typer.Option("--interpolate", help="Interpolate where sample times differ.")
    ] = False,
    junit: Annotated[Path | None, typer.Option(help="Write a JUnit report to this file.")] = None,
    as_json: Json = False,
) -> None:
    """Compare a result file with a reference; exit code 0 if equal within tolerance, else 1."""
    from vehicledyn.interface.comparing import UnusableResultError

    try:
        comparison = vehicledyn.compare(
            result,
            reference,
            relative=relative,
            absolute=absolute,
            tolerances=tolerance_of_channels(tolerances or []),
            channels=channels or None,
            allow_missing=allow_missing,
            interpolate=interpolate,
        )
    except UnusableResultError as error:
        comparison = error.comparison
    code = CODES_OF_VERDICTS[comparison.verdict]
    if junit is not None:
        write_text(junit, comparison.as_junit())
    if as_json:
        emit(to_json({"verdict": "", "exit_code": code} | comparison.as_dict()))
    else:
        emit(comparison.as_text())
    raise typer.Exit(code)


def plot(
    results: Annotated[
        list[Path], typer.Argument(metavar="RESULT...", help="Result files to plot together.")
    ],
    folder: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Folder, or a picture file (.png, .svg, .pdf) for a single figure; "
            "RESULT_plots if absent.",
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Plot this figure, channel or pattern of channels; may be repeated.",
            autocompletion=figure_names,
        ),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="CHANNEL",
            help="Plot channels against this one instead of time.",
            autocompletion=channel_names,
        ),
    ] = None,
    formats: Annotated[
        str, typer.Option("--format", metavar="FORMATS", help="png, svg or both.")
    ] = "png,svg",
) -> None:
    """Plot standard figures or any channels of one or more results; print the files written."""
    wanted = tuple(filter(None, (text.strip() for text in formats.split(","))))
    if not wanted or not set(wanted) <= set(Format):
        raise InputError(f"--format {formats}: write png, svg or png,svg")
    if against is not None and not only:
        raise InputError(f"--against {against}: name the channels to draw with --only")
    paths = dict(zip(labels(results), results, strict=True))
    target = folder or results[0].parent / f"{_joined(results)}_plots"
    if only:
        from vehicledyn.results.labelled.data import open_result
        from vehicledyn.results.labelled.requested import save_requested

        data = {name: open_result(path) for name, path in paths.items()}
        written = save_requested(data, target, patterns=only, against=against, formats=wanted)
    else:
        from vehicledyn.results.labelled.requested import save_standard

        written = save_standard(paths, target, formats=wanted)
    for path in written:
        emit(str(path))


def labels(paths: Sequence[Path]) -> list[str]:
    """Return short names that tell files apart: stems, with folders where these are equal."""
    for depth in (1, 2, 3):
        found = ["/".join((*path.parts[-depth:-1], path.stem)) for path in paths]
        if len(set(found)) == len(found):
            return found
    return [f"{path} ({number})" for number, path in enumerate(paths, 1)]


def _joined(paths: Sequence[Path]) -> str:
    first, *others = (path.stem for path in paths)
    if len(others) > 1:
        return f"{first}_and_{len(others)}_others"
    return "_and_".join([first, *others])


def info(result: ResultFile, as_json: Json = False) -> None:
    """Show the contents of a result file."""
    from vehicledyn.results.info import describe_result
    from vehicledyn.results.plots.table_results import describe_table, holds_table
    from vehicledyn.results.store.study_reader import is_study_file
    from vehicledyn.results.study_info import describe_study

    if is_study_file(result):
        emit_report(describe_study(result), as_json=as_json)
    else:
        report = describe_table(result) if holds_table(result) else describe_result(result)
        emit_report(report, as_json=as_json)


def assess(
    result: ResultFile,
    *,
    begin: Annotated[
        str | None, typer.Option("--from", metavar="TIME", help="Start of the assessed section.")
    ] = None,
    end: Annotated[
        str | None, typer.Option("--to", metavar="TIME", help="End of the assessed section.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="JSON file to write in addition.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Assess running safety, comfort and wear of a rail vehicle's run."""
    first, last = _time("--from", begin), _time("--to", end)
    from vehicledyn.results.assessment.report import assess_result

    report = assess_result(result, begin=first, end=last)
    emit_report(report, as_json=as_json, file=output)


def _time(option: str, text: str | None) -> float | None:
    try:
        return None if text is None else to_si(text, "s")
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
