from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io import run_log
from muybridge.io.run_log import (
    create_log,
    generator_from_words,
    generator_words,
    job_digest,
    read_header,
    read_last,
    read_records,
    resume_log,
)

SOURCE = Path(__file__).resolve().parents[2] / "src"
FIELDS = {"frame": ("i8", ()), "pose": ("f8", (3,)), "lost": ("?", ()), "rng": ("u8", (6,))}
DIGEST = job_digest({"seed": 1})


def values(frame):
    return {"frame": frame, "pose": np.arange(3) + frame, "lost": frame % 2 == 0, "rng": np.full(6, frame, np.uint64)}


def write(path, count=20):
    with create_log(path, FIELDS, DIGEST) as log:
        for frame in range(count):
            log.append(**values(frame))
    return path


def frames(path):
    return [int(record["frame"]) for record in read_records(path)]


def test_records_come_back_as_they_were(tmp_path):
    path = write(tmp_path / "new" / "run.log")
    for frame, record in enumerate(read_records(path)):
        for name, value in values(frame).items():
            assert np.array_equal(record[name], value)
    assert frame == 19 and read_last(path)["frame"] == 19
    assert read_header(path).job_digest == DIGEST
    assert read_last(write(tmp_path / "empty.log", 0)) is None


def test_a_resumed_log_equals_one_written_in_one_go(tmp_path):
    whole, halves = write(tmp_path / "a.log"), write(tmp_path / "b.log", 8)
    with resume_log(halves, DIGEST) as log:
        assert log.count == 8
        for frame in range(8, 20):
            log.append(**values(frame))
    assert whole.read_bytes() == halves.read_bytes()


def test_every_possible_cut_loses_only_the_record_it_hits(tmp_path):
    path = write(tmp_path / "run.log", 4)
    data, header = path.read_bytes(), read_header(path)
    for size in range(header.size, len(data)):
        path.write_bytes(data[:size])
        whole = (size - header.size) // header.record_size
        assert frames(path) == list(range(whole))
    with resume_log(path, DIGEST) as log:
        log.append(**values(3))
    assert path.read_bytes() == data


def test_every_damaged_byte_is_noticed(tmp_path):
    path = write(tmp_path / "run.log", 4)
    data, header = path.read_bytes(), read_header(path)
    for place in range(header.size, len(data)):
        damaged = bytearray(data)
        damaged[place] ^= 0x40
        path.write_bytes(bytes(damaged))
        assert frames(path) == list(range((place - header.size) // header.record_size))


def test_swapped_records_are_noticed(tmp_path):
    path = write(tmp_path / "run.log", 4)
    data, header = path.read_bytes(), read_header(path)
    records = [data[header.size + k * header.record_size :][: header.record_size] for k in (0, 2, 1, 3)]
    path.write_bytes(data[: header.size] + b"".join(records))
    assert frames(path) == [0]


@pytest.mark.parametrize("tail", [bytes(500), b"\xff" * 37])
def test_a_tail_of_zeros_or_rubbish_is_dropped(tmp_path, tail):
    path = write(tmp_path / "run.log")
    path.write_bytes(path.read_bytes() + tail)
    assert frames(path) == list(range(20))


def test_a_killed_process_loses_no_record_it_finished(tmp_path):
    program = textwrap.dedent("""
        import numpy as np
        from muybridge.io.run_log import create_log
        log = create_log("run.log", {"frame": ("i8", ()), "particles": ("f8", (500, 31))}, "job")
        for frame in range(10**6):
            log.append(frame=frame, particles=np.full((500, 31), frame))
            if frame % 10 == 0:
                print(frame, flush=True)
    """)
    for _ in range(3):
        with subprocess.Popen(
            [sys.executable, "-c", program], cwd=tmp_path, env={"PYTHONPATH": str(SOURCE)}, stdout=subprocess.PIPE
        ) as process:
            process.stdout.readline()
            time.sleep(0.1)
            os.kill(process.pid, signal.SIGKILL)
            said = [0] + [int(line) for line in process.stdout.read().split(b"\n")[:-1] if line]
        found = [(int(record["frame"]), record["particles"]) for record in read_records(tmp_path / "run.log")]
        assert [frame for frame, _ in found] == list(range(len(found)))
        assert len(found) > said[-1]
        assert all((particles == frame).all() for frame, particles in found)


@pytest.mark.parametrize("content", [b"", b"frame,time_s\n", pickle.dumps({"a": 1}), b"\x89PNG\r\n\x1a\n"])
def test_foreign_files_are_refused_in_one_line(tmp_path, content):
    path = tmp_path / "run.log"
    path.write_bytes(content)
    for use in (lambda: list(read_records(path)), lambda: resume_log(path, DIGEST)):
        with pytest.raises(InputError, match="expected a run log of muybridge") as caught:
            use()
        assert "\n" not in str(caught.value)
    assert path.read_bytes() == content  # and left as they are


def test_a_cut_or_damaged_header_is_refused(tmp_path):
    path = write(tmp_path / "run.log", 2)
    data, size = path.read_bytes(), read_header(path).size
    for cut in range(8, size):
        path.write_bytes(data[:cut])
        with pytest.raises(InputError, match="whole header"):
            read_header(path)
    for place in range(8, size):
        damaged = bytearray(data)
        damaged[place] ^= 1
        path.write_bytes(bytes(damaged))
        with pytest.raises(InputError, match="whole header"):
            read_header(path)


def test_a_missing_log_is_refused(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        resume_log(tmp_path / "run.log", DIGEST)


def test_another_format_version_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(run_log, "FORMAT_VERSION", 99)
    path = write(tmp_path / "run.log", 1)
    monkeypatch.undo()
    with pytest.raises(InputError, match="format version: expected 1, got 99"):
        read_header(path)


def test_the_log_of_another_job_is_refused_and_left_alone(tmp_path):
    path = write(tmp_path / "run.log")
    before = path.read_bytes()
    with pytest.raises(InputError, match="changed settings"):
        resume_log(path, job_digest({"seed": 2}))
    assert path.read_bytes() == before


def test_the_digest_depends_on_values_and_not_on_order():
    assert job_digest({"a": 1, "b": [2]}) == job_digest({"b": [2], "a": 1}) != job_digest({"a": 1, "b": [3]})


@pytest.mark.parametrize("wrong", [{"pose": np.zeros(2)}, {"extra": 1}])
def test_records_must_fit(tmp_path, wrong):
    with create_log(tmp_path / "run.log", FIELDS, DIGEST) as log, pytest.raises(InputError):
        log.append(**(values(0) | wrong))


@pytest.mark.parametrize("fields", [{"a": ("O", ())}, {"a": ("U5", ())}, {}, {"a": ("f8", (10**9,))}])
def test_only_numbers_of_a_sane_size_can_be_kept(tmp_path, fields):
    with pytest.raises(InputError):
        create_log(tmp_path / "run.log", fields, DIGEST)


def test_a_generator_goes_on_where_it_was():
    rng = np.random.default_rng(3)
    rng.integers(0, 9, 7, dtype=np.int32)  # leaves half a word behind
    again = generator_from_words(generator_words(rng))
    assert np.array_equal(rng.random(100), again.random(100))
    assert np.array_equal(rng.integers(0, 9, 7, dtype=np.int32), again.integers(0, 9, 7, dtype=np.int32))
    with pytest.raises(InputError, match="PCG64"):
        generator_words(np.random.Generator(np.random.MT19937()))


def test_a_full_disk_is_one_line_and_costs_only_the_last_record(tmp_path):
    path = write(tmp_path / "run.log", 5)
    program = textwrap.dedent("""
        import os, resource, numpy as np, sys
        from muybridge.errors import InputError
        from muybridge.io.run_log import read_records, resume_log
        sys.path.insert(0, sys.argv[1])
        log = resume_log("run.log", sys.argv[2])
        size = os.path.getsize("run.log") + 100  # the next record fits, the one after it only in part
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
        last = next(iter(read_records("run.log")))
        try:
            for _ in range(3):
                log.append(**{name: last[name] for name in last.dtype.names})
        except InputError as error:
            sys.exit(f"{log.count} {error}")
    """)
    pytest.importorskip("resource")
    ended = subprocess.run(
        [sys.executable, "-c", program, str(SOURCE), DIGEST],
        cwd=tmp_path,
        env={"PYTHONPATH": str(SOURCE)},
        stderr=subprocess.PIPE,
        check=False,
    )
    assert ended.stderr.startswith(b"6 run.log: expected room to write, got File too large")
    assert len(frames(path)) == 6
