"""Readers of input from outside: what is meant is read, what is malformed is an error of this package, quickly."""

import random
import time
import tracemalloc

import pytest

from elbowroom.errors import BagError
from elbowroom.evaluate.malformed import targets as all_targets
from elbowroom.evaluate.malformed.campaign import DUE
from elbowroom.evaluate.malformed.fuzzing import left_alone
from elbowroom.evaluate.malformed.targets import Target, quietly, target_of, targets
from elbowroom.evaluate.malformed.trial import Trial
from elbowroom.sources.bags import depth

MUTANTS = {"modbus": 60, "recording": 60, "site": 60}
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
    assert all_targets.LEAST_LIMIT == 1 << 26
