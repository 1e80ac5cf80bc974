"""The verb on studies: sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import Backend, BackendChoice, Json, Overrides, Quiet, Verbose
from vehicledyn.cli.performing import conclude, perform
from vehicledyn.cli.replacing import STUDY, Overwrite, Resume, check_replacing
from vehicledyn.cli.terminal import listen

if TYPE_CHECKING:
    from vehicledyn.studies import LoadedStudy

LANES = (1, 4, 8)


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(sweep)


def read_study(path: Path, overrides: list[str] | None) -> LoadedStudy:
    """Return a study, read with all catalogues present."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.studies import load_study

    return load_study(find_file(path, "study"), overrides or ())


def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="Study file, or its name in the library.")
    ],
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result file; STUDY.h5 if absent."),
    ] = None,
    overrides: Overrides = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=4096,
            help="Number of processes, at most eight per core; one per core if absent.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Address of a Dask scheduler whose workers are used: tls://HOST:PORT.",
        ),
    ] = None,
    tls: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Certificates for the scheduler: ca.pem, cert.pem, key.pem."
        ),
    ] = None,
    lanes: Annotated[
        int | None, typer.Option(help="Cases computed together in each process (SIMD): 1, 4 or 8.")
    ] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Run all cases of a study on all cores or on a cluster; write one result file."""
    if lanes is not None and lanes not in LANES:
        raise InputError(f"--lanes {lanes}: choose 1, 4 or 8")
    if scheduler is not None and workers is not None:
        raise InputError("--scheduler has workers of its own; leave --workers out")
    if (scheduler is None) != (tls is None):
        raise InputError("--scheduler and --tls belong together; see docs/sweeps.md")
    loaded = read_study(study, overrides)
    from vehicledyn.studies.cluster import ClusterAddress

    listen(quiet=quiet, verbose=verbose)
    result = output or Path(f"{study.stem}.h5")
    check_replacing(result, STUDY, overwrite=overwrite, resume=resume)
    data = perform(
        vehicledyn.sweep,
        loaded,
        save_to=result,
        workers=workers,
        lanes=lanes,
        resume=resume,
        overwrite=overwrite,
        backend=backend.value,
        cluster=ClusterAddress(scheduler, tls) if scheduler and tls else None,
        quiet=quiet,
        verbose=verbose,
    )
    conclude(data, plots=None, as_json=as_json, quiet=quiet)
