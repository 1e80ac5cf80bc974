"""Stops analyses before a step is kept, and compares what they come to."""

import h5py
import numpy as np

from vehicledyn.results.hdf5.checkpoint import Checkpoint


def stopped(monkeypatch, number):
    """Stop like Ctrl-C before a step of this number is kept; return how many steps there were."""
    steps, put = [], Checkpoint.put

    def counted(self, key, data):
        steps.append(key)
        if len(steps) == number:
            raise KeyboardInterrupt
        put(self, key, data)

    monkeypatch.setattr(Checkpoint, "put", counted)
    return steps


def arrays(path):
    """Return the bytes of all numbers but checksums, which are of blocks as they came in time."""
    with h5py.File(path) as file:
        found = {}
        file.visititems(lambda name, item: found.update({name: item}))
        return {
            name: item[()].tobytes()
            for name, item in found.items()
            if getattr(item, "dtype", np.dtype("O")).kind in "fic" and "checksums" not in name
        }
