"""Runs the program on one hostile input in a forked child, and says what it must never do.

The parent has everything imported, so a case costs no start. Limits of the child make sure that
no case outlives its ten seconds of processor time, hangs or fills the memory. A command that is
asked for more work than that is interrupted as by Ctrl-C: it must have kept what it did until then,
and end at once. Campaigns run several cases in a child, as forking and copying pages costs as much
as a small case; what goes wrong in company is run again alone, and that counts.
"""

import contextlib
import faulthandler
import math
import multiprocessing
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import dataclass, field
from pathlib import Path

from watch import ASLEEP_SECONDS, Watch

PROCESSOR_SECONDS = 10
SECONDS_TO_END = 3
"""Processor time in which an interrupted command ends [s]."""
INTERRUPTED = 130
MOST_MEMORY = 1 << 30
MOST_TEXT = 200_000
CODES = {0, 1, 2, 3, 4, 5}
_ADDRESS_SPACE = 6 << 30
_TOGETHER = 64  # cases of a child
_ESCAPED = 99


@dataclass(frozen=True)
class Case:
    """Files by name, the command on them, and the outputs that it may leave."""

    name: str
    files: dict
    command: list
    outputs: tuple = ()


@dataclass
class Outcome:
    """How a command ended: exit code or signal, text, processor time [s], memory [bytes]."""

    case: Case
    code: int | None
    signal: int | None
    text: str
    seconds: float
    memory: int
    began: float = 0.0  # [s], as files count time
    left: list = field(default_factory=list)
    faults: list = field(default_factory=list)


def run(case, keep=None):
    """Run a case in a folder of its own, in company, and return what became of it."""
    return _COMPANY.run(case, keep)


def run_alone(case, keep=None):
    """Run a case in a folder and a child of its own and return what became of it."""
    folder = Path(tempfile.mkdtemp(prefix="hostile-"))
    try:
        before = write(case.files, folder)
        outcome = _run_in(folder, case)
        outcome.left = sorted(_listed(folder) - before)
        outcome.faults = list(_faults(outcome, folder))
        if outcome.faults and keep is not None:
            _keep(outcome, folder, Path(keep))
        return outcome
    finally:
        shutil.rmtree(folder, ignore_errors=True)


class Company:
    """A child that runs case after case, replaced where one ends it and after some cases."""

    def __init__(self):
        self._child = None
        self._cases = 0

    def run(self, case, keep=None):
        """Run a case and return what became of it, alone where that is a fault."""
        place = Path(tempfile.mkdtemp(prefix="hostile-"))
        folder = place / "case"
        try:
            folder.mkdir()
            before = write(case.files, folder)
            outcome = self._outcome(case, folder, place / "output")
            outcome.left = sorted(_listed(folder) - before)
            if not any(_faults(outcome, folder)):
                return outcome
        finally:
            shutil.rmtree(place, ignore_errors=True)
        self.end()
        return run_alone(case, keep)

    def end(self):
        """Let the child end."""
        if self._child is None:
            return None
        number, ours = self._child
        self._child, self._cases = None, 0
        ours.close()
        _, status = os.waitpid(number, 0)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(number, signal.SIGKILL)
        return status

    def _outcome(self, case, folder, output):
        began = time.time()
        if self._child is None:
            self._child = self._begin()
        self._cases += 1
        try:
            self._child[1].send((str(folder), str(output), case.command))
            code, seconds, memory = Watch(self._child[0]).receive(self._child[1])
        except (EOFError, OSError):
            status = self.end()
            code, seconds, memory = None, PROCESSOR_SECONDS, 0
        else:
            status = self.end() if self._cases == _TOGETHER else None
        text = output.read_bytes()[: 4 * MOST_TEXT] if output.exists() else b""
        died = os.WTERMSIG(status) if code is None and os.WIFSIGNALED(status) else None
        return Outcome(case, code, died, text.decode("utf-8", "replace"), seconds, memory, began)

    def _begin(self):
        ours, theirs = multiprocessing.Pipe()
        number = os.fork()
        if number == 0:
            ours.close()
            with contextlib.suppress(BaseException):
                _begin_child()
                while True:
                    theirs.send(_served(*theirs.recv()))
            os._exit(0)
        theirs.close()
        return number, ours


_COMPANY = Company()


def _served(folder, output, command):
    """Run a command among others in a child; return exit code, processor time, memory."""
    Path("/proc/self/clear_refs").write_text("5")  # the most memory is counted anew
    environment, began = dict(os.environ), _used()
    stream = os.open(output, os.O_RDWR | os.O_CREAT)
    os.chdir(folder)
    _take_streams(stream)
    os.close(stream)
    _limit(began)
    try:
        code = call(command)
    except BaseException:
        traceback.print_exc()
        code = _ESCAPED
    for name in (sys.stdout, sys.stderr):
        name.flush()
    os.environ.clear()
    os.environ.update(environment)
    os.chdir("/")
    most = re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text())
    return code, _used() - began, 1024 * int(most[1])


def _used():
    """Return the processor time of this process and its children [s]."""
    return sum(os.times()[:4])


def write(files, folder):
    """Write files by name, whose content is bytes or a function of the path; return what is there.

    It costs as much as a small case: no more system calls than it takes.
    """
    base = str(folder)
    for name in {name.rpartition("/")[0] for name in files}:
        os.makedirs(f"{base}/{name}", exist_ok=True)  # noqa: PTH103
    for name, content in files.items():
        if callable(content):
            content(folder / name)
        else:
            number = os.open(f"{base}/{name}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
            with os.fdopen(number, "wb", buffering=0) as stream:
                stream.write(content)
    return _listed(folder) if any(map(callable, files.values())) else set(files)


def _listed(folder):
    """Return the names of all files and links below a folder."""
    base, found = len(f"{folder}/"), set()
    for place, below, names in os.walk(folder):
        links = [name for name in below if (Path(place) / name).is_symlink()]
        found.update(f"{place}/{name}"[base:] for name in (*names, *links))
    return found


def _run_in(folder, case, limited=True):
    began = time.time()
    sys.stdout.flush()
    sys.stderr.flush()
    with tempfile.TemporaryFile() as output:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # threads of the test runner
            number = os.fork()
        if number == 0:
            _be_child(folder, case, output, limited)
        status, usage = Watch(number).wait()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(number, signal.SIGKILL)
        output.seek(0)
        text = output.read(4 * MOST_TEXT).decode("utf-8", "replace")
    ended = os.WIFEXITED(status)
    return Outcome(
        case=case,
        code=os.WEXITSTATUS(status) if ended else None,
        signal=None if ended else os.WTERMSIG(status),
        text=text,
        seconds=usage.ru_utime + usage.ru_stime,
        memory=usage.ru_maxrss * 1024,
        began=began,
    )


def _be_child(folder, case, output, limited):
    code = _ESCAPED
    try:
        _begin_child()
        os.chdir(folder)
        _take_streams(output.fileno())
        if limited:
            _limit()
        code = call(case.command)
    except BaseException:
        traceback.print_exc()
    finally:
        with contextlib.suppress(BaseException):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _begin_child():
    os.setpgid(0, 0)
    with open(os.devnull) as nothing:  # noqa: PTH123
        os.dup2(nothing.fileno(), 0)
    for name in ("SIGALRM", "SIGXCPU"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    for name in ("SIGINT", "SIGPROF"):
        signal.signal(getattr(signal, name), signal.default_int_handler)
    os.environ["VEHICLEDYN_CC"] = "none"
    os.environ.pop("VEHICLEDYN_TRACEBACK", None)
    faulthandler.disable()  # pytest's; its stack dump goes to the runner's own stderr


def _take_streams(output):
    """Undo what a test runner does to standard streams and warnings."""
    for stream in (1, 2):
        os.dup2(output, stream)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    warnings.resetwarnings()
    for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
        warnings.simplefilter("ignore", kind)
    warnings.showwarning = lambda *facts: sys.stderr.write(warnings.formatwarning(*facts[:4]))


def _limit(used=0.0):
    """Limit this process, which has used so much processor time [s] before."""
    signal.setitimer(signal.ITIMER_PROF, PROCESSOR_SECONDS)
    seconds = math.ceil(used + PROCESSOR_SECONDS + SECONDS_TO_END)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, resource.getrlimit(resource.RLIMIT_CPU)[1]))
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESS_SPACE, _ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def call(command):
    """Call the program as its command line does; return the exit code."""
    from vehicledyn.cli import main

    argv, sys.argv = sys.argv, ["vehicledyn", *command]
    try:
        main()
    except SystemExit as end:
        if isinstance(end.code, int) or end.code is None:
            return end.code or 0
        print(end.code, file=sys.stderr)  # noqa: T201
        return 1
    finally:
        sys.argv = argv


def _faults(outcome, folder):
    """Yield what the program promises not to do and did."""
    text, code = outcome.text, outcome.code
    if outcome.signal in (signal.SIGXCPU, signal.SIGKILL) and outcome.seconds > 0.9 * (
        PROCESSOR_SECONDS
    ):
        yield f"more than {PROCESSOR_SECONDS} s of processor time"
    elif outcome.signal == signal.SIGALRM:
        yield f"hangs (asleep for {ASLEEP_SECONDS} s)"
    elif outcome.signal is not None:
        yield f"killed by signal {outcome.signal}"
    elif code == INTERRUPTED and outcome.seconds > 0.9 * PROCESSOR_SECONDS:
        if not _keeps_its_work(outcome, folder):
            yield f"more than {PROCESSOR_SECONDS} s of processor time, and nothing kept lately"
    elif code not in CODES:
        yield f"exit code {code}: {_last_line(text)}"
    if "Traceback (most recent call last)" in text and code != _ESCAPED:
        yield "a traceback"
    if warned := re.search(r"[^\n]{0,100}\wWarning: [^\n]{0,100}", text[:MOST_TEXT]):
        yield f"a warning of Python's: {warned[0]}"
    if re.search("^out of memory$", text, re.MULTILINE):
        yield "out of memory"
    if outcome.memory > MOST_MEMORY:
        yield f"{outcome.memory / 2**20:.0f} MiB of memory"
    if len(text) > MOST_TEXT:
        yield f"more than {MOST_TEXT} letters of output"
    if code and not text.strip():
        yield f"exit code {code} without a word"
    if outcome.signal is None:
        yield from _leftovers(outcome, folder)


def _keeps_its_work(outcome, folder):
    """Return whether an interrupted command wrote to its outputs in the later half of its time."""
    half = 0.5 * (outcome.began + time.time())
    return any(
        (folder / name).stat().st_mtime > half
        for name in outcome.left
        if name in outcome.case.outputs
    )


def _leftovers(outcome, folder):
    outputs = list(outcome.case.outputs)
    if outcome.code == 1:  # a search that took all its runs may go on with more
        outputs += [f"{output}.checkpoint" for output in outcome.case.outputs]
    for name in outcome.left:
        if not any(name == output or name.startswith(f"{output}/") for output in outputs):
            yield f"leaves {re.sub('[0-9a-f]{6,}|_[a-z0-9_]{8}', '*', name)}"
        elif outcome.code == 2 and name.endswith(".h5"):
            yield from _taken_for_whole(folder / name)


def _taken_for_whole(path):
    """Yield whether a result that a refused command left is not marked as partial."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            status = file.attrs.get("status", None)
            state = file["state"][0].decode() if "state" in file else None
    except OSError:
        return
    if "ok" in (status, state):
        yield f"exit code 2, but {path.name} looks whole"


def _last_line(text):
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else ""


def _keep(outcome, folder, place):
    target = place / re.sub(r"\W+", "_", outcome.case.name)
    with contextlib.suppress(OSError, shutil.Error):
        shutil.copytree(folder, target, dirs_exist_ok=True)
        words = " ".join(map(repr, outcome.case.command))
        story = f"{words}\n{outcome.faults}\n{outcome.text[-20000:]}"
        (target / "STORY.txt").write_text(story, encoding="utf-8")
