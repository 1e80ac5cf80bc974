"""How far figures of a scenario's run or of an analysis are from measured ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.failed_runs import with_values
from vehicledyn.studies.figures.run_figures import RunFigures
from vehicledyn.studies.identification.experiments import Experiment, SampleFit
from vehicledyn.studies.identification.identified import Unknowns
from vehicledyn.studies.identification.measured_figures import MeasuredFigure, MeasuredFigures

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FigureFitting:
    """Measured figures of an experiment, all of its run or all of one analysis."""

    experiment: Experiment
    number: int
    measured: MeasuredFigures
    runs: Memory
    progress: Progress

    def residuals(self, unknowns: Unknowns, point: Floats) -> tuple[Floats, Floats]:
        """Return model less measurement in deviations of the noise, and the Jacobian.

        Raises
        ------
        NumericalError
            If the run or analysis fails, or a derivative does not exist.
        """
        values, slopes = self._values(unknowns, point)
        parts = [_missed(item, values, slopes) for item in self.measured.items]
        return np.concatenate([part[0] for part in parts]), np.vstack([part[1] for part in parts])

    def fits(self, unknowns: Unknowns, point: Floats) -> list[SampleFit]:
        """Return the fit of every value, figure by figure."""
        values, slopes = self._values(unknowns, point)
        found = []
        for item in self.measured.items:
            missed, _ = _missed(item, values, slopes)
            unit = self.measured.of.units[item.figures[0]] or "1"
            about = Quantity(item.name, unit, f"Measured {item.name}")
            found.append(
                SampleFit(
                    about,
                    item.over,
                    item.places,
                    item.values,
                    item.values + missed * item.noise,
                    missed,
                )
            )
        return found

    def warnings_at(self, unknowns: Unknowns, point: Floats) -> list[str]:
        """Return what is to be known of the figures at a point."""
        own = dict(zip(unknowns.names, map(float, point), strict=True))
        return [*self.measured.of.notes, *self.measured.of.unconfirmed(own)]

    def _values(
        self, unknowns: Unknowns, point: Floats
    ) -> tuple[dict[str, float], dict[str, list[float]]]:
        """Return figures by name, and their slopes."""
        key = self.experiment.name, self.number, point
        entry = self.runs.recall("figures", key, lambda: self._found(unknowns, point))
        if "failure" in entry:
            raise NumericalError(f"{with_values(unknowns.quantities, point)}: {entry['failure']}")
        return entry["values"], entry["slopes"]

    def _found(self, unknowns: Unknowns, point: Floats) -> dict[str, Any]:
        """Return figures and slopes at a point, or why there are none."""
        source, title = self.measured.of, self.experiment.loaded.title
        is_run = isinstance(source, RunFigures)  # which start values move, too
        moving = [k for k, n in enumerate(unknowns.names) if is_run or n in source.parameters]
        names = [unknowns.names[k] for k in moving]
        changes = {unknowns.names[k]: float(point[k]) for k in moving}
        try:
            pairs, failure, _ = source.at(changes, names, follows=True, progress=self.progress)
        except NumericalError as error:
            return {"failure": f"{title}: {error}"}
        if failure:
            return {"failure": f"{title}: {failure}"}
        values, slopes = {}, {}
        for name, (figure, _) in zip(source.units, pairs, strict=True):
            if figure.trouble:
                return {"failure": f"{title}: '{name}' has no derivative: {figure.trouble}"}
            row = np.zeros(len(point))
            row[moving] = figure.slope
            values[name], slopes[name] = float(figure.value), row.tolist()
        return {"values": values, "slopes": slopes}


def _missed(
    item: MeasuredFigure, values: dict[str, float], slopes: dict[str, list[float]]
) -> tuple[Floats, Floats]:
    """Return model less measurement of a figure in deviations of the noise, and the slopes."""
    missed = np.array([values[name] for name in item.figures]) - item.values
    if item.is_phase:
        missed = np.remainder(missed + np.pi, 2.0 * np.pi) - np.pi
    rows = np.array([slopes[name] for name in item.figures])
    return missed / item.noise, rows / item.noise[:, None]
