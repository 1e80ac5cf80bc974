"""Tracks and tyres looked at from Python."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from vehicledyn.base.checked_arguments import checked
from vehicledyn.interface.quantities import positive
from vehicledyn.interface.running import result_place
from vehicledyn.library import locate
from vehicledyn.results.labelled.data import LabelledData


@checked
def track(
    source: str | Path,
    *,
    every: float | str | None = None,
    speed: float | str | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
) -> LabelledData:
    """Return a railway track along its chainage: plan, curvature, cant, gradient, rails.

    Parameters
    ----------
    source
        File of a track, or path or name of a scenario or system that has one.
    every
        Distance of the places [m]; about 25 places if None.
    speed
        Speed for which the cant deficiency is given [m/s].
    save_to, overwrite
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        ``x``, ``y``, ``z``, ``heading``, ``curvature``, ``cant`` and more over the chainage ``s``.

    Raises
    ------
    InputError
        If the file has no track.
    """
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.contact.track_view import view_track

    path = locate(str(source), ("scenario", "system"))
    step = None if every is None else positive("every", every, "m")
    velocity = None if speed is None else positive("speed", speed, "m/s")
    with result_place(save_to, may_exist=overwrite) as place:
        return place.value(view_track(path, every=step, speed=velocity, output=place.path))


@checked
def tyre(
    file: str | Path,
    *,
    other: str | Path | None = None,
    loads: Iterable[float | str] = (),
    convention: str | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
) -> LabelledData:
    """Return the curves of a tyre property file (.tir), and those of a second one beside.

    Parameters
    ----------
    file, other
        Tyre property files.
    loads
        Loads [N]; half, once and 1.5 times the nominal load if there are none.
    convention
        Rules where public programs disagree; the usual ones if None.
    save_to, overwrite
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        ``tyre_1.lateral.slip_angle``, ``tyre_1.lateral.lateral_force`` and so on, by tyre, sweep
        ("longitudinal", "lateral", "cambered", "combined") and quantity.

    Raises
    ------
    InputError
        If a file cannot be read.
    """
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.tyres.curves import view_tyre

    used = [positive("loads", load, "N") for load in loads]
    second = None if other is None else Path(other)
    with result_place(save_to, may_exist=overwrite) as place:
        found = view_tyre(
            Path(file), other=second, loads=used, convention=convention, output=place.path
        )
        return place.value(found)
