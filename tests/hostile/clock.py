"""Notes when a command keeps a step, by its own processor time, also if it is killed."""

import mmap
import time

import numpy as np

_ASKED, _KEPT, _MISSED = range(3)


class Clock:
    """Processor times of a process that is started with :meth:`change`; zero is never."""

    def __init__(self):
        self._times = np.frombuffer(mmap.mmap(-1, 4096), float)

    def change(self):
        """Note in the process when it first asks for a step, misses one, and last keeps one."""
        from vehicledyn.results.hdf5.checkpoint import Checkpoint

        times, get, put = self._times, Checkpoint.get, Checkpoint.put

        def asked(checkpoint, key):
            times[_ASKED] = times[_ASKED] or time.process_time()
            found = get(checkpoint, key)
            if found is None:
                times[_MISSED] = times[_MISSED] or time.process_time()
            return found

        def kept(checkpoint, key, data):
            put(checkpoint, key, data)
            times[_KEPT] = time.process_time()

        Checkpoint.get, Checkpoint.put = asked, kept

    def lost(self, seconds):
        """Return what a process computed in vain that was killed after some seconds [s]."""
        asked, kept = self._times[_ASKED], self._times[_KEPT]
        return seconds - max(asked, kept) if asked else 0.0

    @property
    def repeated(self):
        """Time from the first step that is asked for to the first that is not known [s]."""
        return max(0.0, self._times[_MISSED] - self._times[_ASKED])
