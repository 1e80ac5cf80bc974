"""A worker process that dies of one case, or before it is ready."""

import os
import signal
import sys

from vehicledyn.studies import worker_process

compute = worker_process.compute_remotely


def poisoned(work, first, stop):
    if first <= int(os.environ["POISON"]) < stop:
        os.kill(os.getpid(), signal.SIGKILL)
    return compute(work, first, stop)


if __name__ == "__main__":
    if os.environ["POISON"] == "start":
        sys.exit("no such luck")
    worker_process.compute_remotely = poisoned
    worker_process.main()
