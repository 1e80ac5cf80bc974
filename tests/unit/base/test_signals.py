import signal

import pytest

from vehicledyn.base.interrupts import heeded, undisturbed


def test_ctrl_c_waits_for_the_end_of_the_block():
    done = []
    with pytest.raises(KeyboardInterrupt), undisturbed():
        signal.raise_signal(signal.SIGINT)
        done.append("block")
    assert done == ["block"]


def test_ctrl_c_interrupts_what_it_is_let_through_to():
    done = []
    with undisturbed() as interrupts:
        with pytest.raises(KeyboardInterrupt), interrupts.let_through():
            signal.raise_signal(signal.SIGINT)
        done.append("block")
    assert done == ["block"]
    assert not interrupts.is_pressed


def test_ctrl_c_that_was_taken_for_a_failure_is_heeded():
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), heeded():
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise RuntimeError from None
    assert signal.getsignal(signal.SIGINT) is before


def test_programs_that_ignore_ctrl_c_go_on():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with undisturbed() as interrupts:
            signal.raise_signal(signal.SIGINT)
        assert not interrupts.is_pressed
    finally:
        signal.signal(signal.SIGINT, before)


def test_without_ctrl_c_nothing_changes():
    before = signal.getsignal(signal.SIGINT)
    with undisturbed():
        pass
    assert signal.getsignal(signal.SIGINT) is before
