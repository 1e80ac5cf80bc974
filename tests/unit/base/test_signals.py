import signal

import pytest

from vehicledyn.base.interrupts import undisturbed


def test_ctrl_c_waits_for_the_end_of_the_block():
    done = []
    with pytest.raises(KeyboardInterrupt), undisturbed():
        signal.raise_signal(signal.SIGINT)
        done.append("block")
    assert done == ["block"]


def test_without_ctrl_c_nothing_changes():
    before = signal.getsignal(signal.SIGINT)
    with undisturbed():
        pass
    assert signal.getsignal(signal.SIGINT) is before
