"""The command line: verbs that each call one public function, and what ends them."""

from __future__ import annotations

import atexit
import gc
import io
import os
import sys
from typing import NoReturn

from vehicledyn.base.errors import VehicledynError
from vehicledyn.cli.exit_codes import INPUT, INTERRUPTED, code_of_error
from vehicledyn.cli.unforeseen import describe_failure

__all__ = ["main"]

_COLLECTED_AFTER = 500_000, 20, 20
"""Thresholds of the garbage collector, reached less often than usual: reading and generating code
make many objects and hardly any garbage, and searching them for it took a tenth of the time."""


def main() -> NoReturn:
    """Run the command line and leave with its exit code.

    0 ok, 1 negative result, 2 invalid input or usage, 3 numerical failure, 4 missing optional
    part, 5 some cases of a study failed, 70 a bug of this program, 130 interrupted.
    """
    _open_closed_streams()
    if os.environ.get("VEHICLEDYN_TRACEBACK"):
        _run()
    try:
        _run()
    except VehicledynError as error:
        _leave(str(error), code_of_error(error))
    except KeyboardInterrupt:
        _leave("interrupted", INTERRUPTED)
    except MemoryError:
        _leave("out of memory", INPUT)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _leave(f"{where}{error.strerror or error}", INPUT)
    except Exception as error:  # the edge of the program
        _leave(*describe_failure(error))


def _open_closed_streams() -> None:
    """Give closed standard streams somewhere to go; a result file could take their numbers."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number, this one
    sys.stdout = sys.stdout or open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115


def _run() -> NoReturn:
    gc.set_threshold(*_COLLECTED_AFTER)
    atexit.register(gc.freeze)  # what is left at the end goes with the process, unsearched
    # Other packages' plugins of pydantic have no part in this; looking for them takes a while.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from vehicledyn.cli.foreign_warnings import plain_foreign_warnings
    from vehicledyn.cli.verbs import command_for

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    with plain_foreign_warnings():
        command_for(sys.argv[1:])(prog_name="vehicledyn")
        sys.exit(0)


def _leave(text: str, code: int) -> NoReturn:
    from vehicledyn.cli.terminal import tell

    tell(text)
    sys.exit(code)
