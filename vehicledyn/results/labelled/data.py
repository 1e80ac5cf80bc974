"""A result of any analysis as a set of labelled arrays, read from its file when asked for."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError, UnknownNameError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.base.report import Report
from vehicledyn.results.hdf5.output import check_output, write_failed
from vehicledyn.results.labelled.array import LabelledArray
from vehicledyn.results.labelled.source import Source
from vehicledyn.results.labelled.sources import source_of
from vehicledyn.results.store.near_names import unknown_array

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

    from vehicledyn.results.store.layout import EventRecord, SummaryEntry


class LabelledData(Mapping[str, LabelledArray]):
    """Labelled arrays by name, with how the analysis ended and its key figures.

    It behaves as a read-only mapping: ``data["chassis.yaw_rate"]`` is an array, ``list(data)``
    are the names. A file that belongs to it alone is removed with it.

    Attributes
    ----------
    kind
        "run", "study", "modes", "response", "hunt", "contacts", "equilibrium" or "cam".
    title, model
        What was computed, of which model.
    status, status_message
        "ok" for a whole result, else how it ended and why.
    attributes
        Further facts by name: versions, creation, speed.
    is_temporary
        Whether the file goes with this value.
    report
        What the command line prints: ``report.as_text()`` and ``report.as_dict()``; None for a
        file that was opened.
    """

    def __init__(
        self, path: Path, *, owned_folder: Path | None = None, report: Report | None = None
    ) -> None:
        self._path = path
        self.report = report
        self._source: Source = source_of(path)
        self._arrays: dict[str, LabelledArray] = {}
        if owned_folder is not None:
            weakref.finalize(self, shutil.rmtree, str(owned_folder), ignore_errors=True)
        self.is_temporary = owned_folder is not None
        head = self._source.head
        self.kind, self.title, self.model = head.kind, head.title, head.model
        self.status, self.status_message = head.status, head.message
        self.attributes: Mapping[str, Any] = head.attributes

    @property
    def path(self) -> Path:
        """The file; of a result that was not saved a temporary one."""
        return self._path

    @property
    def is_whole(self) -> bool:
        """Whether the analysis reached its planned end."""
        return self.status == "ok"

    @property
    def summary(self) -> Mapping[str, SummaryEntry]:
        """Key figures by name, each with value, unit and description; of a sweep there are none.

        Those of an identification are its parameters, of an uncertainty the means of its figures,
        of an optimum its variables and figures, and what is said of each is in its description.
        """
        return self._source.summary()

    @property
    def events(self) -> tuple[EventRecord, ...]:
        """Events of a run, each with time and name."""
        return self._source.events()

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks and warnings of the analysis."""
        return self._source.notes()

    @property
    def time(self) -> Any:
        """Times of the samples, shape (n_times,) [s].

        Raises
        ------
        InputError
            If the result has no time.
        """
        return self["time"].values

    @checked
    def __getitem__(self, name: str) -> LabelledArray:
        """Return an array.

        Raises
        ------
        UnknownNameError
            If there is none of this name; the nearest one is suggested.
        """
        if name not in self._source.names:
            raise UnknownNameError(unknown_array(str(name), self._source.names))
        return self._read([name])[0]

    @checked
    def arrays(self, *patterns: str) -> list[LabelledArray]:
        """Return the arrays that match any of some shell patterns, all if none is given.

        Quicker than one after the other.

        Raises
        ------
        InputError
            If a pattern matches nothing.
        """
        return self._read(self.names(*patterns))

    def _read(self, names: Sequence[str]) -> list[LabelledArray]:
        missing = [name for name in names if name not in self._arrays]
        if missing:
            self._arrays |= dict(zip(missing, self._source.read(missing), strict=True))
        return [self._arrays[name] for name in names]

    def __eq__(self, other: object) -> bool:
        """Return whether it is the same object; ``vehicledyn.compare`` compares what they hold."""
        return self is other

    __hash__ = object.__hash__

    def __contains__(self, name: object) -> bool:
        """Return whether there is an array of this name."""
        return name in self._source.names

    def __iter__(self) -> Iterator[str]:
        """Yield the names in the order of the model."""
        return iter(self._source.names)

    def __len__(self) -> int:
        """Return the number of arrays."""
        return len(self._source.names)

    @checked
    def names(self, *patterns: str) -> list[str]:
        """Return the names that match any of some shell patterns, all if none is given.

        Raises
        ------
        InputError
            If a pattern matches nothing.
        """
        if not patterns:
            return list(self)
        found: list[str] = []
        for pattern in patterns:
            matching = [name for name in self if fnmatchcase(name, pattern)]
            if not matching:
                raise InputError(unknown_array(pattern, self._source.names))
            found += [name for name in matching if name not in found]
        return found

    @checked
    def to_xarray(self, *patterns: str) -> xarray.Dataset:
        """Return an ``xarray.Dataset`` of the arrays that match; xarray must be installed."""
        from vehicledyn.results.labelled.conversion import data_set

        return data_set(self, patterns)

    @checked
    def to_dataframe(self, *patterns: str) -> pandas.DataFrame:
        """Return a pandas table: one column an array, the dimensions as index.

        Without patterns the arrays over the main dimensions are taken: the time of a run, the
        cases of a study, cases and modes of eigenmodes, the parameters of an identification, the
        figures of an uncertainty, the variables of an optimum.
        """
        from vehicledyn.results.labelled.conversion import data_frame

        return data_frame(self, patterns)

    @checked
    def plot(
        self,
        *patterns: str,
        against: str | None = None,
        others: Sequence[LabelledData] | Mapping[str, LabelledData] = (),
    ) -> Figure:
        """Return a figure of arrays by names or patterns, several results in one picture.

        Parameters
        ----------
        patterns
            Names or shell patterns; each unit gets a panel of its own. The name of a standard
            figure draws that one; without any the first standard figure is drawn.
        against
            Array along the horizontal axis, the first dimension if left out.
        others
            Further results to draw into the same panels, or these by label.

        Raises
        ------
        InputError
            If a pattern matches nothing; the nearest name is suggested.
        """
        from vehicledyn.results.labelled.requested import draw_requested

        if isinstance(others, LabelledData):
            others = [others]
        if not isinstance(others, Mapping):
            others = {f"{other.title} ({k})": other for k, other in enumerate(others, 2)}
        return draw_requested({self.title: self, **others}, patterns, against)

    @checked
    def save(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write the whole result to a file, which every command reads; return its path.

        Raises
        ------
        InputError
            If the file exists and ``overwrite`` is false, or cannot be written.
        """
        target = Path(path)
        if target.exists() and not overwrite:
            raise InputError(f"{target}: exists; choose another path, or give overwrite=True")
        check_output(target)
        try:
            with whole_file(target) as scratch:
                shutil.copyfile(self._path, scratch)
        except OSError as error:
            raise write_failed(target, error) from error
        return target

    @checked
    def export(self, path: str | Path, *patterns: str, overwrite: bool = False) -> Path:
        """Write arrays as a table: .csv, .mat or .parquet by the name of the file; return its path.

        Raises
        ------
        InputError
            If the file exists and ``overwrite`` is false, has another suffix or cannot be written.
        MissingPartError
            If the package for this format is not installed.
        """
        from vehicledyn.results.labelled.export import export_data

        return export_data(self, Path(path), patterns, overwrite=overwrite)

    def __repr__(self) -> str:
        """Return what it is and what it holds, in some lines."""
        from vehicledyn.results.labelled.display import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        from vehicledyn.results.labelled.display import as_html

        return as_html(self)


@checked
def open_result(path: str | Path) -> LabelledData:
    """Return a result file of any analysis: a run, study, modes, responses, cycles or contacts.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or no result.
    """
    return LabelledData(Path(path))
