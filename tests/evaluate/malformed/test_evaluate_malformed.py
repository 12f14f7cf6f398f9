"""Readers of input from outside: what is meant is read, what is malformed is an error of this package, quickly."""

import random
import sys
import time
import tracemalloc

import numpy as np
import pytest

from elbowroom.errors import BagError, InputError
from elbowroom.evaluate.malformed import campaign
from elbowroom.evaluate.malformed.campaign import DUE
from elbowroom.evaluate.malformed.fuzzing import left_alone
from elbowroom.evaluate.malformed.targets import LEAST_LIMIT, Target, quietly, target_of, targets
from elbowroom.evaluate.malformed.trial import Trial, memory_held
from elbowroom.sources.bags import depth

MUTANTS = {"modbus": 60, "recording": 60, "site": 60}
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="memory is held on Linux alone")
NAMES = [target.name for target in targets()]


def mutated(seed: bytes, chance: random.Random) -> bytes:
    """A seed with bits turned, numbers made large, parts cut out, doubled or put elsewhere."""
    data = bytearray(seed)
    for _ in range(chance.randint(1, 4)):
        at, length = chance.randrange(len(data) + 1), chance.randint(1, 40)
        kind = chance.randrange(6)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << chance.randrange(8)
        elif kind == 1:
            data[at : at + 4] = chance.choice((b"\xff\xff\xff\xff", b"\x00\x00\x00\x00", b"\xff\xff\xff\x7f"))
        elif kind == 2:
            del data[at : at + length]
        elif kind == 3:
            data[at:at] = data[at : at + length]
        elif kind == 4:
            data[at:at] = chance.randbytes(chance.randint(1, 8))
        else:
            other = chance.randrange(len(data) + 1)
            data[at : at + length] = data[other : other + length]
    return bytes(data)


@pytest.mark.parametrize("name", NAMES)
def test_inputs_as_they_are_meant_are_read(name, tmp_path):
    if name == "modbus":
        pytest.importorskip("pymodbus")
    target = target_of(name)
    for seed in target.seeds():
        assert len(seed) <= target.longest
        target.read(seed, tmp_path)


def test_all_images_of_the_seeds_are_looked_at(tmp_path, monkeypatch):
    looked = []
    real = depth.depth_of
    monkeypatch.setattr(depth, "depth_of", lambda *given: looked.append(given[2]) or real(*given))
    for name in ("mcap", "sqlite3"):
        target = target_of(name)
        target.read(target.seeds()[-1], tmp_path)
        assert {"/a/depth/image", "/b/depth/compressedDepth", "/c/depth/image"} <= set(looked)
        looked.clear()


@pytest.mark.parametrize("name", NAMES)
def test_malformed_inputs_are_errors_of_this_package(name, tmp_path):
    if name == "modbus":
        pytest.importorskip("pymodbus")
    target, chance = target_of(name), random.Random(1)
    trial = Trial(target, tmp_path, tmp_path)
    seeds = target.seeds()
    for number in range(MUTANTS.get(name, 120)):
        trial.one(mutated(seeds[number % len(seeds)], chance))
    assert dict(trial.found) == {}


def wrong(act) -> Target:
    return Target("it", lambda data, folder: act(), lambda: [b""], 9, 9)


def test_a_crash_a_hang_and_an_allocation_are_kept_once_each(tmp_path, monkeypatch):
    def crash():
        raise KeyError("x")

    def allocate():
        raise MemoryError

    monkeypatch.setattr("elbowroom.evaluate.malformed.trial.SLOW_S", 0.05)
    for act, kind in ((crash, "crash"), (allocate, "allocation"), (lambda: busy(0.08), "slow")):
        folder = tmp_path / kind
        folder.mkdir()
        trial = Trial(wrong(act), folder, folder)
        trial.one(b"one")
        trial.one(b"two")
        assert [*trial.found.values()] == [2]
        (kept,) = folder.glob(f"it-{kind}-*")
        assert kept.read_bytes() == b"one"


def test_a_reader_that_loads_a_module_first_does_not_hang(tmp_path, monkeypatch):
    monkeypatch.setattr("elbowroom.evaluate.malformed.trial.SLOW_S", 0.05)
    first = iter([0.08])
    trial = Trial(wrong(lambda: busy(next(first, 0.0))), tmp_path, tmp_path)
    trial.one(b"")
    assert not trial.found and trial.runs == 1


@LINUX
def test_what_a_reader_may_take_is_beside_what_was_taken_before_it(tmp_path):
    taken = []
    trial = Trial(
        wrong(lambda: taken.append(np.empty(LEAST_LIMIT, np.uint8))), tmp_path, tmp_path, holds=True
    )
    for _ in range(5):
        trial.one(b"")
    assert not trial.found and len(taken) == 5


@LINUX
def test_more_than_twice_the_limit_is_refused_and_only_within(tmp_path):
    def take():
        return np.empty(16 * LEAST_LIMIT, np.uint8)

    with pytest.raises(MemoryError), memory_held(wrong(take)):
        take()
    assert take().size
    trial = Trial(wrong(take), tmp_path, tmp_path, holds=True)
    trial.one(b"")
    assert [key.split()[0] for key in trial.found] == ["allocation"]


class Dies:
    """A process that ends at once, having said something."""

    def __init__(self, code, words, stdout, **_):
        stdout.write(words)
        self.returncode = code

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def poll(self):
        return self.returncode

    def kill(self):
        pass


@pytest.mark.parametrize(
    ("code", "log"),
    [(1, b"#8192 pulse cov: 31 ft: 9\nMemoryError: std::bad_alloc"), (-9, b""), (1, b"no atheris")],
)
def test_a_process_that_dies_is_a_row_and_the_next_reader_begins(code, log, tmp_path, monkeypatch):
    monkeypatch.setattr(campaign, "package", lambda name: None)
    monkeypatch.setattr(campaign.subprocess, "Popen", lambda words, stdout, stderr: Dies(code, log, stdout))
    rows = list(campaign.malformed_rows(0.1, ("mask", "joints"), tmp_path / "kept" / "here"))
    assert [row["target"] for row in rows] == ["mask", "joints"]
    for row in rows:
        (found,) = row["found"]
        tried = 8192 if b"#8192" in log else 0
        assert (
            f"the experiment ended after {tried} inputs" in found["error"] and f"by {code}" in found["error"]
        )
        assert log[-10:].decode() in found["error"]
        assert row["crashes"] == 1 and row["cpu_s"] is None
        assert [due.met(row) for due in DUE] == [False, True, True]


def test_where_inputs_cannot_be_kept_is_said_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr(campaign, "package", lambda name: None)
    (tmp_path / "kept").write_bytes(b"")
    with pytest.raises(InputError, match="is no folder"):
        next(campaign.malformed_rows(0.1, ("mask",), tmp_path / "kept"))


def busy(seconds):
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def test_an_error_of_this_package_is_an_answer(tmp_path):
    def refuse():
        raise BagError("it is none")

    trial = Trial(wrong(refuse), tmp_path, tmp_path)
    trial.one(b"")
    assert not trial.found and trial.runs == 1


def test_kernels_are_left_as_they_are():
    alone = set(left_alone())
    assert {"elbowroom.wire.kernels.depth", "elbowroom.sensing.kernels", "elbowroom.motion.check"} <= alone
    assert not {"elbowroom.wire.depth_codec", "elbowroom.sources.bags.bag", "elbowroom.files"} & alone
    assert [due.key for due in DUE] == ["crashes", "hangs", "allocations"]


def test_a_small_input_takes_little_memory(tmp_path):
    target, chance = target_of("mcap"), random.Random(2)
    quietly(target, target.seeds()[0], tmp_path)
    tracemalloc.start()
    for _ in range(30):
        quietly(target, mutated(target.seeds()[1], chance), tmp_path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 40_000_000
    assert LEAST_LIMIT == 1 << 26
