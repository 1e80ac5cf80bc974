"""Damaged files are found out and named, and never make HDF5 loop."""

import multiprocessing
import os
import re
import struct

import h5py
import numpy as np
import pytest
from result_files import Quantity, header

from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5 import heaps, journal, seal, superblock
from vehicledyn.results.hdf5.disk import Container
from vehicledyn.results.hdf5.finishing import finish
from vehicledyn.results.hdf5.opening import noticing_damage, open_file
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.writer import ResultWriter

LIMIT = 20.0  # s


def everything(path, answer):
    """Read all of a result; put what came of it into a queue."""
    try:
        with open_result(path) as result:
            text = repr((result.scenario_text, result.summary, result.sources, result.plots))
            text += repr([result.channel(name).values.tolist() for name in result.channels])
            text += repr(result.states.values.tolist())
        answer.put(("read", text))
    except InputError as error:
        answer.put(("refused", str(error)))


def within_limit(path):
    context = multiprocessing.get_context("fork")
    answer = context.SimpleQueue()
    process = context.Process(target=everything, args=(path, answer))
    process.start()
    process.join(LIMIT)
    hangs = process.is_alive()
    if hangs:
        process.kill()
        process.join()
    return ("hangs", "") if hangs else answer.get()


def unsealed(path):
    """Cut the seal off, as a program that changes the file does."""
    size = path.stat().st_size
    with path.open("r+b") as file:
        file.truncate(seal.read_seal(file.fileno(), size).body)


@pytest.mark.parametrize("sealed", [True, False])
def test_a_zeroed_heap_of_texts_is_damage_and_no_endless_loop(make_result, sealed):
    path = make_result()
    if not sealed:
        unsealed(path)
    data = bytearray(path.read_bytes())
    places = list(heaps.heaps_in(bytes(data), 0))
    assert places
    for place in places:
        size = struct.unpack_from("<Q", data, place + 8)[0]
        broken = data.copy()
        broken[place + 16 : place + size] = bytes(size - 16)
        path.write_bytes(broken)
        kind, message = within_limit(path)
        assert kind == "refused" and "is damaged" in message


@pytest.mark.long
def test_every_wrong_byte_of_a_sealed_file_is_found(make_result):
    path = make_result()
    data = path.read_bytes()
    known = within_limit(path)
    assert known[0] == "read"
    random = np.random.default_rng(14)
    for place in random.integers(0, len(data), 40):
        broken = bytearray(data)
        broken[place] ^= 1 << int(random.integers(8))
        path.write_bytes(broken)
        kind, text = within_limit(path)
        assert kind == "refused" or (kind, text) == known


def test_damage_is_named_with_channel_and_times(tmp_path):
    path = tmp_path / "long.h5"
    time = 0.01 * np.arange(20_000)
    channels = [Quantity(f"body.{name}", "m") for name in "xyz"]
    with ResultWriter(path, channels=channels, header=header(), expected_samples=20_000) as writer:
        writer.append(time, np.column_stack([np.sin(k * time) for k in (1, 2, 3)]))
    data = path.read_bytes()
    with h5py.File(path) as file:
        chunk = file["body/y"].id.get_chunk_info(2)
        rows = file["body/y"].chunks[0]
    broken = bytearray(data)
    broken[chunk.byte_offset + 100] ^= 4
    told = r"body\.y, rows \d+ to \d+ \(t = [\d.]+ to [\d.]+ s\)"
    for cut in (False, True):
        path.write_bytes(broken)
        if cut:
            unsealed(path)
        with open_result(path) as result:
            for name in ("body.x", "body.z") if cut else ():
                assert len(result.channel(name).values) == 20_000
            with pytest.raises(InputError, match=told) as caught:
                result.channel("body.y")
        first, stop = map(
            int, re.search(r"body\.y, rows (\d+) to (\d+)", str(caught.value)).groups()
        )
        assert first <= 2 * rows + 1 + 12 <= stop


def test_a_killed_run_has_checksums_too(tmp_path):
    path, copy = tmp_path / "running.h5", tmp_path / "left.h5"
    writer = ResultWriter(
        path, channels=[Quantity("x", "m")], states=[Quantity("q", "m")], header=header()
    )
    time = 0.1 * np.arange(1500)
    for part in np.split(time, 3):
        writer.append(part, part[:, None], 2.0 * part[:, None])
        writer._flush(writer._container)
    copy.write_bytes(path.read_bytes())
    writer.close()
    data = bytearray(copy.read_bytes())
    with open_result(copy) as result:
        assert not result.is_whole
        assert np.array_equal(result.states.values[:, 0], 2.0 * time)
    place = data.find(np.float64(2.0 * time[700]).tobytes())
    data[place] ^= 1
    copy.write_bytes(data)
    with (
        open_result(copy) as result,
        pytest.raises(InputError, match=r"wrong checksum of states/value, rows 501 to 1000"),
    ):
        assert result.states


def test_a_lost_seal_is_damage(make_result):
    path = make_result()
    data = path.read_bytes()
    for broken in (data[:-3], data[:-40] + bytes(40), data + b"more"):
        path.write_bytes(broken)
        with pytest.raises(InputError, match="checksums"):
            open_result(path)


class Killed(BaseException):
    pass


@pytest.fixture
def unfinished(tmp_path):
    """A file as a kill leaves it."""
    path = tmp_path / "a.h5"
    container = Container(path, new=True)
    container.file.create_dataset("x", data=np.arange(50_000.0))
    container.file.attrs["status"] = "running"
    container.file.swmr_mode = True
    container.flush()
    container.abandon()
    return path


def change(file):
    file.attrs["status"] = "ok"
    file.create_dataset("more", data=np.ones(300))


def status(path):
    file = open_file(path)
    with file, noticing_damage(file):
        assert np.array_equal(file["x"][()], np.arange(50_000.0))
        told = str(file.attrs["status"])
        assert (told == "ok") == ("more" in file)
        if told == "ok":
            assert np.array_equal(file["more"][()], np.ones(300))
        return told


def test_finishing_is_whole_or_nothing_wherever_it_is_killed(unfinished, monkeypatch):
    before, told = unfinished.read_bytes(), set()
    write, count = journal.write_all, [0, 0]

    def interrupted(file, data):
        count[0] += 1
        if count[0] == count[1]:
            write(file, data[: len(data) // 2])
            raise Killed
        write(file, data)

    monkeypatch.setattr(journal, "write_all", interrupted)
    finished = False
    while not finished:
        count[:] = 0, count[1] + 1
        unfinished.write_bytes(before)
        try:
            finish(unfinished, change)
            finished = True
        except Killed:
            told.add(status(unfinished))
    assert told == {"running", "ok"} and count[1] > 3
    assert status(unfinished) == "ok"
    with unfinished.open("rb") as file:
        assert seal.read_seal(file.fileno(), os.fstat(file.fileno()).st_size) is not None
    assert not superblock.is_open_with_readers(unfinished.read_bytes()[:48])


def test_finishing_without_space_changes_nothing(unfinished, monkeypatch):
    before, write = unfinished.read_bytes(), journal.write_all
    for most in (0, 100, 3000, 5000):
        left = [most]

        def limited(file, data, left=left):
            write(file, data[: left[0]])
            if len(data) > left[0]:
                raise OSError(28, "No space left on device")
            left[0] -= len(data)

        monkeypatch.setattr(journal, "write_all", limited)
        with pytest.raises(OSError, match="No space"):
            finish(unfinished, change)
        assert unfinished.read_bytes() == before


def test_a_wrong_name_in_a_killed_run_is_found(tmp_path):
    path, copy = tmp_path / "running.h5", tmp_path / "left.h5"
    writer = ResultWriter(path, channels=[Quantity("body.height", "m")], header=header())
    writer.append(np.arange(3.0), np.zeros((3, 1)))
    writer._flush(writer._container)
    data = path.read_bytes()
    writer.close()
    places = [m.start() for m in re.finditer(rb"body\.height|Nine cones", data)]
    assert places
    for place in places:
        broken = bytearray(data)
        broken[place + 2] ^= 1
        copy.write_bytes(broken)
        with pytest.raises(InputError, match=r"is damaged"):
            open_result(copy)
    copy.write_bytes(data)
    with open_result(copy) as result:
        assert result.channels == ("body.height",)


@pytest.mark.parametrize("name", ["animation", "summary", "scene", "scenario"])
def test_a_dataset_in_place_of_a_group_is_damage(make_result, name):
    """To look for a name in it would be to read all of the numbers that it says to hold."""
    path = make_result()
    unsealed(path)
    with h5py.File(path, "r+") as file:
        if name in file:
            del file[name]
        file.create_dataset(name, shape=(1 << 50,), chunks=(1000,), dtype=float)
    kind, message = within_limit(path)
    assert kind == "refused" and f"{name} is no group" in message


def test_a_text_that_is_no_utf_8_is_damage(make_result):
    path = make_result()
    unsealed(path)
    data = path.read_bytes()
    title = open_result(path).title.encode()
    assert data.count(title) >= 1
    path.write_bytes(data.replace(title, b"\xcf" + title[1:]))
    with pytest.raises(InputError, match=r"is damaged \(a text that is no UTF-8\)"):
        open_result(path)
