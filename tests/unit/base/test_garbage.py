"""The search for circles of objects is put off, and on again whatever happens."""

import gc

import pytest

from vehicledyn.base.garbage import without_collection


def test_collection_is_back_after_an_error():
    with pytest.raises(ValueError, match="inside"), without_collection():
        assert not gc.isenabled()
        raise ValueError("inside")
    assert gc.isenabled()


def test_collection_that_was_off_stays_off():
    gc.disable()
    try:
        with without_collection():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
