"""Studies of many cases from Python."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.argument_names import argument
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place, Problem
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.files.scenario.overrides import read_override
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.library import locate
from vehicledyn.results.labelled.data import LabelledData
from vehicledyn.studies.cluster import ClusterAddress
from vehicledyn.studies.load import LoadedStudy, load_study, study_of
from vehicledyn.studies.sweep import run_study


@checked
def sweep(
    study: Source | LoadedStudy,
    *,
    vary: Settings | None = None,
    cases: Settings | None = None,
    set: Settings | None = None,
    channels: str | Iterable[str] | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    workers: int | None = None,
    lanes: int | None = None,
    cluster: ClusterAddress | None = None,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the results of many cases of one scenario.

    Parameters
    ----------
    study
        Path or name of a study; or a scenario or model, if ``vary`` or ``cases`` says what varies.
    vary
        For keys of the scenario their values, as a list or as ``{"from": 1, "to": 2, "count": 5}``;
        all combinations are computed.
    cases
        In place of ``vary`` the section "cases" of a study, such as ``{"kind": "random",
        "number": 100, "seed": 1, "vary": {"speed": {"from": "10 m/s", "to": "20 m/s"}}}``.
    set, settings
        As for :func:`vehicledyn.simulate`; of a study file also fields of the study.
    channels
        Names or patterns of the channels to keep of each case; the scenario's if None, ``[]`` for
        key figures alone.
    save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped study left in ``save_to``.
    workers
        Processes, eight a core at most; one a core if None.
    lanes
        Cases side by side in each process: 1, 4 or 8; what suits if None.
    cluster
        Dask scheduler whose workers compute in place of processes on this machine.

    Returns
    -------
    LabelledData
        What varies and the key figures over ``case``, the channels over ``case`` and ``time``.
        Failed cases warn.

    Raises
    ------
    InputError
        If the study, the scenario or a setting cannot be used.
    NumericalError
        If the equations cannot be set up.
    """
    changes = override_texts(set, settings)
    kept = None if channels is None else texts("channels", channels, at_least=0)
    if isinstance(study, LoadedStudy):
        loaded = study
    elif vary is None and cases is None:
        loaded = _from_file(study, changes, kept)
    elif vary is not None and cases is not None:
        raise InputError(f"{argument('vary')} and {argument('cases')}: give one of the two")
    else:
        wanted = cases if vary is None else {"kind": "grid", "vary": vary}
        name = argument("cases" if vary is None else "vary")
        places: dict[Place, str] = {
            ("cases", "vary", key): f"{name}[{key!r}]" for key in vary or ()
        }
        loaded = _from_scenario(
            read_scenario(study, changes), wanted or {}, kept, {("cases",): name, **places}
        )
    with result_place(save_to, may_exist=resume or overwrite) as place:
        outcome = run_study(
            loaded,
            output=place.path,
            workers=workers,
            lanes=lanes,
            resume=resume,
            overwrite=overwrite,
            cluster=cluster,
            backend=backend,
            progress=reporter(progress),
        )
        return place.value(outcome)


def _from_file(study: Source, changes: list[str], channels: list[str] | None) -> LoadedStudy:
    if not isinstance(study, str | Path):
        words = "say what varies, such as {'speed': ['10 m/s', '20 m/s']}"
        raise InputError(f"{argument('vary')}: missing: {words}")
    if channels is not None:
        changes = [*changes, *override_texts({"output.channels": channels}, {})]
    return load_study(locate(str(study), ("study",)), changes)


def _from_scenario(
    scenario: LoadedScenario,
    cases: Mapping[str, Any],
    channels: list[str] | None,
    arguments: Mapping[Place, str],
) -> LoadedStudy:
    """Return the study of a scenario, which need not be a file."""
    path = Path(scenario.path).resolve()
    own = scenario.path.read_text(encoding="utf-8-sig") if scenario.path.is_file() else None
    if own not in (None, scenario.text):
        path = path.with_name(f"run of {path.name}")  # the usual run of the system in that file
    data: dict[str, Any] = {
        "title": scenario.scenario.title,
        "scenario": str(path),
        "set": dict(map(_change, scenario.overrides)),
        "cases": json.loads(override_texts({"cases": cases}, {})[0].partition("=")[2]),
    }
    if channels is not None:
        data["output"] = {"channels": channels}
    document = parse_yaml(json.dumps(data, ensure_ascii=False), "the study")
    documents = {str(path): parse_yaml(scenario.text, str(path))}
    place = path.with_name("study.yaml")
    return study_of(document, place, documents=documents, built=scenario.built, arguments=arguments)


def _change(override: str) -> tuple[str, Any]:
    change = read_override(override)
    if isinstance(change, Problem):
        raise InputError(str(change))
    return change.key, change.value
