"""Derivatives of key figures and channels by parameters, as a result file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_quantities,
    read_texts,
    write_axis,
    write_numbers,
    write_quantities,
    write_texts,
)
from vehicledyn.results.tables.response_table import ratio_unit

FORMAT = "vehicledyn-sensitivity"


@dataclass(frozen=True)
class SensitivityTable:
    """Derivatives of figures and channels, in SI.

    ``parameters`` with their ``parameter_values`` (n_parameters,); ``figures`` with ``values``
    (n_figures,) and ``slopes`` (n_figures, n_parameters), not a number where none exists;
    ``channels`` sampled at ``time`` (n_times,) with ``channel_values`` (n_channels, n_times) and
    ``channel_slopes`` (n_channels, n_times, n_parameters). ``curvatures``, shape as ``slopes``, are
    second derivatives along a direction, if any: Hessians of the figures times that.
    ``places`` (n_figures, n_parameters), if any, are the values of the parameters for each figure,
    where these are of several places; ``parameter_values`` then are not a number where they differ.
    """

    title: str
    model: str
    parameters: tuple[Quantity, ...]
    parameter_values: Any
    figures: tuple[Quantity, ...]
    values: Any
    slopes: Any
    channels: tuple[Quantity, ...] = ()
    time: Any = field(default_factory=lambda: np.zeros(0))
    channel_values: Any = field(default_factory=lambda: np.zeros((0, 0)))
    channel_slopes: Any = field(default_factory=lambda: np.zeros((0, 0, 0)))
    notes: tuple[str, ...] = ()
    curvatures: Any = None
    places: Any = None

    def values_at(self, figure: int) -> Any:
        """Return the values of the parameters (n_parameters,) at which a figure was found."""
        return np.asarray(self.parameter_values if self.places is None else self.places[figure])

    @property
    def elasticities(self) -> Any:
        """Change of a figure by a hundredth of a parameter's value, shape as ``slopes``."""
        own = np.asarray(self.parameter_values)[None, :] if self.places is None else self.places
        return 0.01 * np.asarray(self.slopes) * own

    def ranked(self, figure: int) -> list[int]:
        """Return the parameters by what a hundredth of each does to a figure, largest first.

        Those whose value is zero come behind the others, by their derivative.
        """
        effects, slopes = np.abs(self.elasticities[figure]), np.abs(self.slopes[figure])
        keys = [
            (-np.nan_to_num(e), -np.nan_to_num(s)) for e, s in zip(effects, slopes, strict=True)
        ]
        return sorted(range(len(keys)), key=lambda k: keys[k])

    def unit(self, figure: int, parameter: int) -> str:
        """Return the unit of a derivative."""
        return ratio_unit(self.figures[figure].unit, self.parameters[parameter].unit)


def write_sensitivity(path: Path, table: SensitivityTable) -> None:
    """Write derivatives to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    with new_file(path, FORMAT, {"title": table.title, "model": table.model}) as file:
        parameters = write_quantities(file, "parameter", table.parameters)
        figures = write_quantities(file, "figure", table.figures)
        words = ("as parameter", "Value of the parameter")
        write_numbers(file, "parameter_value", table.parameter_values, (parameters,), words)
        words = ("as figure", "Value of the figure")
        write_numbers(file, "figure_value", table.values, (figures,), words)
        words = ("figure/parameter", "Derivative of the figure by the parameter")
        write_numbers(file, "figure_slope", table.slopes, (figures, parameters), words)
        words = ("as figure", "Change of the figure by one per cent of the parameter")
        scales = (figures, parameters)
        write_numbers(file, "figure_change_per_percent", table.elasticities, scales, words)
        if table.curvatures is not None:
            words = ("as figure", "Hessian of the figure times the direction")
            write_numbers(file, "figure_curvature", table.curvatures, scales, words)
        if table.places is not None:
            words = ("as parameter", "Value of the parameter for the figure")
            write_numbers(file, "figure_parameter_value", table.places, scales, words)
        write_texts(file, "notes", table.notes)
        if not table.channels:
            return
        channels = write_quantities(file, "channel", table.channels)
        time = write_axis(file, "time", np.asarray(table.time, dtype=float), ("s", "Time"))
        words = ("as channel", "Value of the channel")
        write_numbers(file, "channel_value", table.channel_values, (channels, time), words)
        words = ("channel/parameter", "Derivative of the channel by the parameter")
        every = (channels, time, parameters)
        write_numbers(file, "channel_slope", table.channel_slopes, every, words)


def read_sensitivity(path: Path) -> SensitivityTable:
    """Return the derivatives in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        parameters, figures = read_quantities(file, "parameter"), read_quantities(file, "figure")
        sizes = Sizes({"parameter": len(parameters), "figure": len(figures)})
        more: dict[str, Any] = {}
        if "channel" in file:
            channels = read_quantities(file, "channel")
            sizes.count("channel", channels, "channel")
            axes = ("channel", "times", "parameter")
            more = {
                "channels": channels,
                "time": sizes.read(file, "time", "times"),
                "channel_values": sizes.read(file, "channel_value", *axes[:2]),
                "channel_slopes": sizes.read(file, "channel_slope", *axes),
            }
        if "figure_curvature" in file:
            more["curvatures"] = sizes.read(file, "figure_curvature", "figure", "parameter")
        if "figure_parameter_value" in file:
            more["places"] = sizes.read(file, "figure_parameter_value", "figure", "parameter")
        return SensitivityTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            parameters,
            sizes.read(file, "parameter_value", "parameter"),
            figures,
            sizes.read(file, "figure_value", "figure"),
            sizes.read(file, "figure_slope", "figure", "parameter"),
            notes=tuple(read_texts(file, "notes")),
            **more,
        )
