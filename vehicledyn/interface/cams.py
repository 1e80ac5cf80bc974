"""Cams from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from vehicledyn.base.argument_names import given
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.interface.quantities import positive, quantity
from vehicledyn.interface.running import result_place
from vehicledyn.results.labelled.data import LabelledData


@checked
def cam(
    description: str | Path | Mapping[str, Any],
    *,
    angles: Iterable[float | str] | None = None,
    profile: str | Path | None = None,
    tolerance: float | str = "1 um",
    save_to: str | Path | None = None,
    overwrite: bool = False,
) -> LabelledData:
    """Return motion, profile, pressure angle, curvature and forces of a cam over a turn.

    Parameters
    ----------
    description
        File of a cam, or a mapping with the same fields.
    angles
        Angles of the cam [rad]; equally distant over a turn if None.
    profile
        Profile for the milling machine to write, DXF or CSV by its ending, in mm.
    tolerance
        Largest distance of the profile's chords from the curve [m].
    save_to, overwrite
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        ``lift``, ``velocity``, ``acceleration``, ``pressure_angle``, ``profile_x``,
        ``profile_radius`` and more over ``angle``; key figures among its attributes.

    Raises
    ------
    InputError
        If the cam cannot be used: its motion does not close, its profile is undercut, its
        follower does not reach.
    """
    from vehicledyn.analyses.cams.view import CamReport, cam_table, drawing_of
    from vehicledyn.base.yaml import Document
    from vehicledyn.cams.cam_file import cam_of, read_cam
    from vehicledyn.results.tables.cam_drawing import write_profile
    from vehicledyn.results.tables.cam_table import write_cam

    if isinstance(description, Mapping):
        found = cam_of(Document("cam", "", {"title": "A cam", **description}), Path())
    else:
        found = read_cam(Path(description))
    allowed, places = positive("tolerance", tolerance, "m"), None
    if angles is not None:
        places = [quantity("angles", angle, "rad") for angle in angles]
        if not places:
            raise InputError("angles: give at least one, or None")
    with result_place(save_to, may_exist=overwrite) as place:
        table = cam_table(found, None if places is None else _column(places))
        write_cam(place.path, table)
        target = None if profile is None else Path(profile)
        if target is not None:
            if target.suffix.lower() not in (".dxf", ".csv"):
                raise InputError(f"{given('profile', str(target))}: must end in .dxf or .csv")
            write_profile(target, drawing_of(found, allowed))
        return place.value(CamReport(table, profile=target))


def _column(values: list[float]) -> Any:
    import numpy as np

    return np.array(values)
