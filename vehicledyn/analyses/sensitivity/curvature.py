"""Second derivatives of a run's figures along a direction: Hessians times a vector."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.adjoint import goes_back
from vehicledyn.analyse.gradients.corner_passages import CornerMissedError
from vehicledyn.analyse.gradients.curvature import Curvature, CurvatureCode
from vehicledyn.analyse.gradients.equilibrium import GivenSlopes
from vehicledyn.analyse.gradients.key_figures import unit_of
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.driving_failures import bent_beams
from vehicledyn.analyses.sensitivity.motion import counted_corners, divided_steps
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import Directions, directions, wanted
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]


@dataclass
class CurvatureStudy:
    """A scenario made ready for second derivatives of figures of its channels."""

    study: MotionStudy
    figures: list[tuple[str, str]]
    code: CurvatureCode

    @staticmethod
    def of(
        study: MotionStudy, figures: list[tuple[str, str]], progress: Progress
    ) -> CurvatureStudy:
        """Prepare figures, each a kind and a channel.

        Raises
        ------
        InputError
            If the run has events, changes its dependent coordinates or is given their rates.
        """
        e = study.prepared.equations
        course = study.changes()
        if not goes_back(e) or (course is not None and course.changes):
            why = "changes its dependent coordinates" if goes_back(e) else "has events"
            raise InputError(
                f"second derivatives: the run of '{e.name}' {why}, which they do not follow; take "
                "differences of its gradient"
            )
        if given := study.written.given_rates():
            raise InputError(
                f"second derivatives do not follow the given rate of '{given[0]}', which depends "
                "on others; give the rates of independent coordinates, or take differences of the "
                "gradient"
            )
        progress("deriving and compiling second derivatives", None)
        names = [c.name for c in e.channels]
        return CurvatureStudy(
            study, figures, CurvatureCode(e, [names.index(n) for _, n in figures])
        )

    def along(
        self, chosen: Directions, direction: Floats, *, divides: bool
    ) -> list[tuple[Curvature, Floats, Floats]]:
        """Return of each figure the curvature, its gradient and Hessian times a direction.

        ``direction`` (n,) and both results are in terms of what derivatives are by; ``divides``
        says whether steps are divided at corners of laws.
        """
        study, kernel = self.study, self.study.prepared.kernel
        tangents = study.start_slopes(chosen) + chosen.by_state
        moved_p, moved_x = chosen.by_parameter @ direction, tangents @ direction
        by_start = tangents
        bends, balanced = study.given_bends(chosen, moved_p), study.balance()
        bent = bends.moving
        if balanced is not None:
            given = study.given_slopes(chosen)
            own = balanced.slopes(study.code, chosen.by_parameter, given) @ direction
            still = given.still @ direction
            doubled = balanced.with_tangents(own, still, moved_p, self.code.n_unknowns)
            by_both = np.pad(chosen.by_parameter, ((0, len(chosen.by_parameter)), (0, 0)))
            given_both = GivenSlopes(
                np.vstack([given.moving, bends.moving]), np.vstack([given.still, bends.still])
            )
            both = doubled.slopes(self.code.code, by_both, given_both)
            bent = both[len(tangents) :]
        found = []
        for place, (kind, _) in enumerate(self.figures):
            item = self.code.along(
                (kernel.parameters, moved_p),
                study.grid,
                n_intervals=study.n_intervals,
                start=(study.start.state, study.start.unknowns, moved_x),
                figure=(kind, place),
                divides=divides,
            )
            slope = item.slope[0] @ chosen.by_parameter + item.slope[1] @ by_start
            curvature = item.curvature[0] @ chosen.by_parameter + item.curvature[1] @ by_start
            found.append((item, slope, curvature + item.slope[1] @ bent))
        return found


def find_curvature(
    loaded: LoadedScenario,
    of: list[str],
    to: list[str],
    along: Mapping[str, float | str],
    progress: Progress,
) -> SensitivityTable:
    """Return gradients of figures of channels, and their Hessians times a direction.

    Parameters
    ----------
    loaded
        The scenario.
    of, to
        Names, see :mod:`vehicledyn.analyses.sensitivity.names`.
    along
        The direction: parts by names as in ``to``, others are zero.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a name means nothing, or the run has no second derivatives.
    NumericalError
        If the run fails, or a derivative does not exist.
    """
    study = MotionStudy.of(loaded, [], progress)
    e, kernel = study.prepared.equations, study.prepared.kernel
    asked = wanted(e, of, [])
    if asked.curves:
        raise InputError(
            f"'{asked.curves[0]}': second derivatives are those of figures of channels, such as "
            f"rms({asked.curves[0]})"
        )
    chosen = directions(e, kernel.parameters, study.start.state, [*to, *along])
    ready = CurvatureStudy.of(study, asked.figures, progress)
    plain = study.plain(progress)
    notes = [*study.notes, *bent_beams(study, plain)]
    progress("following the motion back with its tangents", None)
    wanted_along = _direction(chosen, along, e, study)
    trouble = undivided(plain)
    divides = bool(plain.corners) and not trouble
    try:
        found = ready.along(chosen, wanted_along, divides=divides)
    except CornerMissedError as error:
        found, trouble = ready.along(chosen, wanted_along, divides=False), str(error)
    if trouble:
        notes.append(
            f"warning: {trouble}: these derivatives are those of whole steps, which step over such "
            "places; take differences of gradients"
        )
    else:
        notes += divided_steps(plain)
    slopes, curvatures = [], []
    about = {c.name: c for c in e.channels}
    figures = []
    for (kind, name), (item, slope, curvature) in zip(asked.figures, found, strict=True):
        channel, trouble = about[name], item.figure.trouble
        unit, words = unit_of(kind, channel.unit), f"{kind} of {channel.description}"
        figures.append(Quantity(f"{kind}({name})", unit, words))
        if trouble:
            notes.append(f"warning: '{kind}({name})' has no derivative: {trouble}")
        slopes.append(np.full(slope.shape, np.nan) if trouble else slope)
        curvatures.append(np.full(slope.shape, np.nan) if trouble else curvature)
    return SensitivityTable(
        loaded.title,
        loaded.scenario.model,
        chosen.quantities,
        chosen.values,
        tuple(figures),
        np.array([item.figure.value for item, _, _ in found]),
        np.array(slopes),
        curvatures=np.array(curvatures),
        notes=tuple(notes),
    )


def undivided(plain: MotionSlopes) -> str:
    """Return why second derivatives do not follow divided steps, in words; "" if they do."""
    if plain.left_whole:
        return "laws change their branch all the time"
    if any(corner.jumps for corner in plain.corners):
        return f"the motion passes {counted_corners(plain)}, at which rates jump"
    return ""


def _direction(
    chosen: Directions, along: Mapping[str, float | str], equations: Equations, study: MotionStudy
) -> Floats:
    """Return the direction in terms of what derivatives are by.

    Raises
    ------
    InputError
        If a part is no number or of another unit.
    """
    found = np.zeros(len(chosen.values))
    names = [item.name for item in chosen.quantities]
    for name, given in along.items():
        of = directions(equations, study.prepared.kernel.parameters, study.start.state, [name])
        for quantity in of.quantities:
            try:
                value = given if isinstance(given, int | float) else to_si(given, quantity.unit)
            except InputError as error:
                raise InputError(f"along.{name}: {error}") from None
            found[names.index(quantity.name)] = float(value)
    return found
