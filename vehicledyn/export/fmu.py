"""Write a system as an FMU: FMI 3.0, model exchange, loops solved inside.

The archive holds the model description, the source and, where a C compiler is found, the
binary for this platform.
"""

from __future__ import annotations

import hashlib
import json
import logging
import platform
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import folder_for_files, whole_file
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import KernelFunctions, derive_functions
from vehicledyn.codegen.printers.kernel_source import portable_source
from vehicledyn.codegen.toolchain.compiler import CompilationError, build_library, find_compiler
from vehicledyn.export.document import ExportedStart, start_of
from vehicledyn.export.fmi_description import RunDefaults, build_description, model_description
from vehicledyn.export.identifiers import safe_name
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.tables import CurveTable

_log = logging.getLogger(__name__)
_SYSTEMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
_ENDINGS = {"linux": ".so", "darwin": ".dylib", "win32": ".dll"}
_MACHINES = {"amd64": "x86_64", "arm64": "aarch64", "i386": "x86", "i686": "x86"}
_EPOCH = (1980, 1, 1, 0, 0, 0)


def export_fmu(
    equations: Equations,
    path: Path,
    start: ExportedStart | None = None,
    experiment: RunDefaults | None = None,
) -> Path:
    """Write an FMU and return its path; equal systems give equal files.

    Parameters
    ----------
    equations
        The system; parameters become tunable, channels outputs, events state events.
    path
        File to write.
    start
        Parameters, states and unknowns at the start; the equations' own if None.
    experiment
        What an importer runs by default.

    Raises
    ------
    InputError
        If the file cannot be written, or events move points of contact, which an FMU of this
        kind cannot do.
    """
    jumping = [event.name for event in equations.events if event.guesses]
    if jumping:
        raise InputError(
            f"event '{jumping[0]}' moves a point of contact, which the FMU cannot do; take a "
            "model of contact that needs no such events, such as the elastic one of rails"
        )
    begin, identifier = start or start_of(equations), safe_name(equations.name)
    source = _kernel_and_tables(equations, begin)
    token = f"{{{hashlib.sha256(source.encode()).hexdigest()[:32]}}}"
    source = f'#define TOKEN "{token}"\n{source}\n{_interface()}'
    files = {
        "modelDescription.xml": model_description(
            equations, identifier, token, begin, experiment or RunDefaults()
        ).encode(),
        f"sources/{identifier}.c": source.encode(),
        "sources/buildDescription.xml": build_description(identifier).encode(),
    }
    try:
        files[_binary_name(identifier)] = _binary(source)
    except CompilationError as error:
        _log.warning("%s; the FMU holds its source only, importers have to compile it", error)
    _write(path, files)
    return path


def _kernel_and_tables(equations: Equations, start: ExportedStart) -> str:
    functions = derive_functions(equations)
    return "\n".join([portable_source(equations, functions), *_tables(equations, functions, start)])


def _tables(equations: Equations, functions: KernelFunctions, start: ExportedStart) -> list[str]:
    """Return what fmi3.c needs to know besides the kernel."""
    e = equations
    resets = [pair for event in e.events for pair in event.resets]
    edges = [0]
    for event in e.events:
        edges.append(edges[-1] + len(event.resets))
    failures = [json.dumps(f"the loop {block.name} does not close") for block in e.blocks]
    return [
        f"#define NP {len(e.parameters)}",
        f"#define NC {functions.prepare.numel_out(0)}",
        f"#define NR {functions.resets.numel_out(0)}",
        f"#define NT {ROW * len(e.tables)}",
        *_curves(e.tables),
        _table("double", "parameter_start", [repr(float(v)) for v in start.parameters]),
        _table("double", "state_start", [repr(float(v)) for v in start.state]),
        _table("double", "unknown_start", [repr(float(v)) for v in start.unknowns]),
        _table("int", "is_terminal", [str(int(event.terminal)) for event in e.events]),
        _table("int", "reset_start", [str(edge) for edge in edges]),
        _table("int", "reset_state", [str(state) for state, _ in resets]),
        _table("int", "reset_row", [str(row) for _, row in resets]),
        _table("char *const", "block_failures", failures),
    ]


def _curves(tables: Sequence[CurveTable]) -> list[str]:
    """Return the cells of tables, and the function that writes the rows that look them up."""
    lines, fill = [], []
    for k, table in enumerate(tables):
        items = [repr(float(number)) for number in table.cells.ravel()]
        lines.append(_table("double", f"cells_{k}", items))
        numbers = (table.origin, 1.0 / table.step, table.step, len(table.cells) - 1.0)
        fill += [f"  row[{ROW * k + i}] = {float(item)!r};" for i, item in enumerate(numbers)]
        fill += [f"  place = cells_{k};", f"  memcpy(row + {ROW * k + 4}, &place, sizeof place);"]
    body = ["  const double *place;", *fill] if tables else ["  (void)row;"]
    return [*lines, "static void fill_table_rows(double *row) {", *body, "}"]


def _table(kind: str, name: str, items: Sequence[str]) -> str:
    return f"static const {kind} {name}[] = {{{', '.join(items) or '0'}}};"


def _interface() -> str:
    return Path(__file__).with_name("fmi3.c").read_text(encoding="utf-8")


def _binary(source: str) -> bytes:
    """Return the shared library, for any processor of this machine's kind."""
    compiler = replace(find_compiler(), processor="")
    with tempfile.TemporaryDirectory() as folder:
        return build_library(compiler, source, Path(folder)).read_bytes()


def _binary_name(identifier: str) -> str:
    machine = platform.machine().lower()
    system = _SYSTEMS.get(sys.platform, sys.platform)
    ending = _ENDINGS.get(sys.platform, ".so")
    return f"binaries/{_MACHINES.get(machine, machine)}-{system}/{identifier}{ending}"


def _write(path: Path, files: dict[str, bytes]) -> None:
    try:
        with (
            folder_for_files(path.parent),
            whole_file(path) as place,
            zipfile.ZipFile(place, "w", zipfile.ZIP_DEFLATED) as archive,
        ):
            for name, data in files.items():
                entry = zipfile.ZipInfo(name, _EPOCH)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, data)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
