"""The command line: verbs that each call one public function, and what ends them."""

from __future__ import annotations

import io
import os
import sys
from typing import NoReturn

from vehicledyn.base.errors import VehicledynError

__all__ = ["main"]

INTERRUPTED = 130
BUG = 70


def main() -> NoReturn:
    """Run the command line and leave with its exit code.

    0 ok, 1 negative result, 2 invalid input or usage, 3 numerical failure, 4 missing optional
    part, 70 a bug of this program, 130 interrupted.
    """
    if os.environ.get("VEHICLEDYN_TRACEBACK"):
        _run()
    try:
        _run()
    except VehicledynError as error:
        _leave(str(error), error.exit_code)
    except KeyboardInterrupt:
        _leave("interrupted", INTERRUPTED)
    except MemoryError:
        _leave("out of memory", VehicledynError.exit_code)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _leave(f"{where}{error.strerror or error}", VehicledynError.exit_code)
    except Exception as error:  # the edge of the program: whatever comes here is a bug
        text = " ".join(f"{type(error).__name__}: {error}".split())
        hint = "Set VEHICLEDYN_TRACEBACK=1 to see where, and please report it."
        _leave(f"this is a bug of vehicledyn: {text}. {hint}", BUG)


def _run() -> NoReturn:
    from vehicledyn.cli.verbs import app

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    app(prog_name="vehicledyn")
    sys.exit(0)


def _leave(text: str, code: int) -> NoReturn:
    sys.stderr.write(f"{text}\n")
    sys.exit(code)
