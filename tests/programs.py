"""Runs command lines as a user would type them.

Every start of the program imports a second's worth of packages. Where the system can fork, a
server imports them once, and each command runs in a fork of it: a process of its own, with its own
folder, environment and output. Lines that need a shell and other programs start as usual. Processes
of one check share the server, whose socket is in the folder that VEHICLEDYN_TEST_SERVERS names.
"""

import array
import contextlib
import hashlib
import json
import os
import re
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

TIMEOUT = 300
"""Longest time of a command [s]."""

_SHELL = re.compile(r"[|;&<>$`*?~#\\\n(){}!]")
_QUOTED = re.compile(r"'[^']*'|\"[^\"$`\\!]*\"")
"""What a shell leaves as it is."""
_COMMENT = re.compile(r"\s#[^\n]*$")
_READ_AT_START = re.compile(
    r"PYTHON|MPL|OMP_|OPENBLAS_|LD_|LC_|LANG|COLUMNS|TERM|NO_COLOR|CI$|_TYPER_"
)
_SERVER = Path(__file__).parent / "warm_server.py"


def run(command, folder, **environment):
    """Run a command in a folder; return what it printed, fail where its exit code is not 0."""
    done = call(command, folder, **environment)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def call(command, folder, **environment):
    """Run a command, a line for the shell or a list of words; return the completed process."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    changed = os.environ | {"PATH": path} | environment
    words = _words(command)
    if _is_served(words) and _can_be_forked(changed):
        return _server().call(words, folder, changed)
    return subprocess.run(
        command, shell=isinstance(command, str), cwd=folder, env=changed, check=False,
        capture_output=True, text=True, timeout=TIMEOUT,
    )  # fmt: skip


def started(command, folder, **environment):
    """Start a command, a list of words; return what waits for it and sends it signals."""
    changed = os.environ | environment
    words = _words(command)
    if _is_served(words) and _can_be_forked(changed):
        return Started(words, folder, changed)
    nothing = subprocess.DEVNULL
    return subprocess.Popen(words, cwd=folder, env=changed, stdout=nothing, stderr=nothing)


def _words(command):
    if not isinstance(command, str):
        return [str(word) for word in command]
    bare = _COMMENT.sub("", _QUOTED.sub("''", command))
    return [] if _SHELL.search(bare) else shlex.split(command, comments="#" in command)


def _is_served(words):
    """Whether a command is the program, a file of Python or a text of Python without options."""
    if words[:1] == ["vehicledyn"]:
        return True
    return words[:1] in (["python"], [sys.executable]) and (
        words[1] == "-c" or not words[1].startswith("-")
    )


def _can_be_forked(environment):
    if not sys.platform.startswith("linux"):
        return False
    return _at_start(environment) == _at_start(os.environ)


def _at_start(environment):
    return {key: value for key, value in environment.items() if _READ_AT_START.match(key)}


class Server:
    """A connection to a process that has imported the program and forks for each command."""

    def __init__(self, connection):
        self._socket = connection
        self._answers = self._socket.makefile("r")

    def call(self, words, folder, environment):
        with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
            child = self.begin(words, folder, environment, (output, errors))
            code = self.end(words, child)
            texts = []
            for file in (output, errors):
                file.seek(0)
                texts.append(file.read().decode())
        return subprocess.CompletedProcess(words, code, *texts)

    def begin(self, words, folder, environment, files):
        """Start a command that writes to files; return the number of its process."""
        request = {"words": words, "folder": str(folder), "environment": environment}
        self._send(json.dumps(request).encode(), [file.fileno() for file in files])
        return int(self._answers.readline())

    def close(self):
        self._answers.close()
        self._socket.close()

    def _send(self, message, files):
        numbers = array.array("i", files)
        rights = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, numbers)]
        self._socket.sendmsg([len(message).to_bytes(8, "big")], rights)
        self._socket.sendall(message)

    def end(self, words, child):
        """Wait for a process and return its exit code."""
        self._socket.settimeout(TIMEOUT)
        try:
            return int(self._answers.readline())
        except TimeoutError:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            raise subprocess.TimeoutExpired(words, TIMEOUT) from None
        finally:
            self._socket.settimeout(None)


class Started:
    """A command in a fork of a server, by the words of ``subprocess.Popen``."""

    def __init__(self, words, folder, environment):
        self.args, self.returncode = words, None
        self._server = Server(_connection())
        with open(os.devnull, "w") as nothing:  # noqa: PTH123
            self.pid = self._server.begin(words, folder, environment, (nothing, nothing))

    def poll(self):
        """Return the exit code of a process that has ended."""
        if self.returncode is None and not Path(f"/proc/{self.pid}").exists():
            self.wait()
        return self.returncode

    def send_signal(self, number):
        if self.poll() is None:
            os.kill(self.pid, number)

    def wait(self):
        if self.returncode is None:
            self.returncode = self._server.end(self.args, self.pid)
            self._server.close()
        return self.returncode


def _connection():
    """Connect to the server of this environment, which the first to ask for it starts."""
    import fcntl

    folder = Path(os.environ["VEHICLEDYN_TEST_SERVERS"])
    folder.mkdir(exist_ok=True, mode=0o700)
    facts = [sys.executable, *sorted(_at_start(os.environ).items())]
    place = folder / hashlib.sha256(repr(facts).encode()).hexdigest()[:16]
    with place.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not place.exists():
            _started.append(start_server(place))
        return connected(place)


def start_server(place, *prefix):
    """Start a server that listens at a place, behind words that start it in another setting."""
    owner = os.environ["VEHICLEDYN_TEST_OWNER"]
    return subprocess.Popen(
        [*prefix, sys.executable, _SERVER, place, owner], start_new_session=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
    )  # fmt: skip


def connected(place):
    """Return a connection to a socket; its server may take a while until it listens."""
    deadline = time.monotonic() + TIMEOUT
    while True:
        found = socket.socket(socket.AF_UNIX)
        try:
            found.connect(str(place))
        except OSError:
            found.close()
            if time.monotonic() > deadline:
                raise
            time.sleep(0.02)
        else:
            return found


_started = []
_servers = {}


def _server():
    """Return the server of this thread and of its environment, started where there is none."""
    key = (os.getpid(), threading.get_ident(), *sorted(_at_start(os.environ).items()))
    if key not in _servers:
        _servers[key] = Server(_connection())
    return _servers[key]
