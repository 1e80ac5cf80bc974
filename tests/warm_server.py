"""Imports the program once and runs each command it is sent in a fork; see ``programs``.

``warm_server.py SOCKET OWNER`` serves whoever connects to the socket until the process OWNER ends.
"""

import gc
import importlib
import itertools
import json
import os
import pkgutil
import runpy
import signal
import socket
import sys
import traceback
import types
import warnings

import pydantic

import vehicledyn
import vehicledyn.cli
from vehicledyn.base import registry
from vehicledyn.files.system.kinds import load_kinds

PACKAGES = (
    "h5py", "jinja2", "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg",
    "matplotlib.figure", "pandas", "ruamel.yaml", "scipy.integrate", "scipy.interpolate",
    "scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.stats", "typer",
)  # fmt: skip


def load():
    """Import the program and what it imports when needed, and make its commands and models."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for found in pkgutil.walk_packages(vehicledyn.__path__, "vehicledyn."):
            if not found.name.endswith("__main__"):
                importlib.import_module(found.name)
        for name in PACKAGES:
            importlib.import_module(name)
    verbs = vehicledyn.cli.verbs
    for verb in (
        "",
        "run",
        "validate",
        "schema",
        "doctor",
        *itertools.chain(*verbs.HOMES.values()),
    ):
        verbs.command_for([verb])
    load_kinds()
    for family in registry.families():
        for kind in registry.kinds(family):
            registry.find(family, kind)  # made when it is first asked for
    for model in _below(pydantic.BaseModel):
        if model.__module__.startswith("vehicledyn."):
            model.model_rebuild()  # no more than is left to be done


def freeze():
    """Leave what there is to itself: a collection in a child would copy every page of it."""
    gc.collect()
    gc.freeze()


def _below(parent):
    for child in parent.__subclasses__():
        yield child
        yield from _below(child)


def serve(connection):
    """Run commands until the other end closes."""
    while True:
        length, files, _, _ = socket.recv_fds(connection, 8, 2)
        if not length:
            return
        request = json.loads(connection.recv(int.from_bytes(length, "big"), socket.MSG_WAITALL))
        child = os.fork()
        if child == 0:
            connection.close()
            _run(request, files)
        for number in files:
            os.close(number)
        connection.sendall(b"%d\n" % child)
        _, status = os.waitpid(child, 0)
        connection.sendall(b"%d\n" % os.waitstatus_to_exitcode(status))


def _run(request, files):
    code = 1
    try:
        os.setpgid(0, 0)
        os.chdir(request["folder"])
        os.environ.clear()
        os.environ.update(request["environment"])
        for stream, number in zip((1, 2), files, strict=True):
            os.dup2(number, stream)
            os.close(number)
        _call(request["words"])
        code = 0
    except SystemExit as end:
        code = _code_of(end)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _call(words):
    """Be the program, a file of Python or, behind ``-c``, a text of it."""
    program, *words = words
    if program == "vehicledyn":
        sys.argv = [program, *words]
        vehicledyn.cli.main()
    elif words[0] == "-c":
        sys.argv = words
        main = types.ModuleType("__main__")
        sys.modules["__main__"] = main
        exec(compile(words[1], "<string>", "exec"), main.__dict__)
    else:
        sys.argv = words
        runpy.run_path(words[0], run_name="__main__")


def _code_of(end):
    if isinstance(end.code, str):
        print(end.code, file=sys.stderr)  # noqa: T201
        return 1
    return end.code or 0


def _serve_all(listening, owner):
    """Serve each connection in a fork while the owner lives."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for them
    listening.settimeout(1.0)
    while _lives(owner):
        try:
            connection, _ = listening.accept()
        except TimeoutError:
            continue
        with connection:
            if os.fork() == 0:
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                listening.close()
                connection.setblocking(True)
                serve(connection)
                os._exit(0)


def _lives(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with socket.socket(socket.AF_UNIX) as waiting:
        waiting.bind(sys.argv[1])
        load()
        freeze()
        waiting.listen(64)
        _serve_all(waiting, int(sys.argv[2]))
