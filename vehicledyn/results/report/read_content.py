"""Opens a result file of any kind for a page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.results.report.content import Content

LARGEST_TABLE = 1 << 30
"""Bytes that a file which is read whole may promise."""


def read_content(path: Path) -> Content:
    """Return what a page shows of a result file of any kind.

    Raises
    ------
    InputError
        If there is no such file, or it is not of this program, damaged, or of a newer version.
    """
    from vehicledyn.results.hdf5.opening import is_open_for_writing
    from vehicledyn.results.plots.table_results import holds_table
    from vehicledyn.results.store.study_reader import is_study_file

    is_open_for_writing(path)  # says what is not there or not HDF5
    if is_study_file(path):
        from vehicledyn.results.report.study_content import study_content

        return study_content(path)
    if holds_table(path):
        from vehicledyn.results.report.table_content import table_content

        _refuse_giants(path)
        return table_content(path)
    from vehicledyn.results.report.run_content import run_content

    return run_content(path)


def _refuse_giants(path: Path) -> None:
    import h5py

    from vehicledyn.results.hdf5.damage import reading
    from vehicledyn.results.hdf5.opening import open_file
    from vehicledyn.results.store.decimation import promises_too_much

    sizes = []

    def measure(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            if promises_too_much(item):
                raise InputError(f"{path}: is damaged: {name} is not in the file; compute it again")
            sizes.append(item.size * item.dtype.itemsize)

    with reading(path), open_file(path) as file, reading(path, file):
        file.visititems(measure)
    if sum(sizes) > LARGEST_TABLE:
        raise InputError(f"{path}: holds {sum(sizes):.3g} bytes, too many for a page")
