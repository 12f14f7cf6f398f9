import subprocess
import sys
import time

from elbowroom._kernel_cache import forget_stale_kernels, only_one


def a_package(folder):
    (folder / "a" / "kernels" / "__pycache__").mkdir(parents=True)
    (folder / "a" / "kernels" / "one.py").write_text("one = 1")
    kept = folder / "a" / "kernels" / "__pycache__" / "one.f-1.py311.1.nbc"
    kept.write_bytes(b"compiled")
    return kept


def test_compiled_kernels_are_kept_while_no_kernel_changes(tmp_path):
    kept = a_package(tmp_path)
    assert forget_stale_kernels(tmp_path)
    kept.write_bytes(b"compiled anew")
    assert not forget_stale_kernels(tmp_path)
    assert kept.exists()


def test_a_change_in_any_kernel_forgets_all_compiled_ones(tmp_path):
    kept = a_package(tmp_path)
    forget_stale_kernels(tmp_path)
    kept.write_bytes(b"compiled anew")
    (tmp_path / "a" / "kernels" / "other.py").write_text("two = 2")
    assert forget_stale_kernels(tmp_path)
    assert not kept.exists()


WITHIN = """
import sys, time
from pathlib import Path
from elbowroom._kernel_cache import only_one
folder = Path(sys.argv[1])
print("ready", flush=True)
sys.stdin.readline()
with only_one("compiles", folder):
    with (folder / "log").open("a") as log:
        log.write("in\\n")
        log.flush()
        time.sleep(0.2)
        log.write("out\\n")
if len(sys.argv) > 2:
    with only_one("compiles", folder):
        print("within", flush=True)
        time.sleep(60)
"""


def a_process(*arguments):
    command = (sys.executable, "-c", WITHIN, *map(str, arguments))
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    return process


def test_of_processes_that_start_at_once_only_one_compiles(tmp_path):
    processes = [a_process(tmp_path) for _ in range(3)]
    for process in processes:
        process.stdin.write("\n")
        process.stdin.flush()
    assert all(process.wait(20) == 0 for process in processes)
    for process in processes:
        process.communicate()
    assert (tmp_path / "log").read_text().split() == ["in", "out"] * 3


def test_a_process_that_is_killed_lets_the_next_one_in(tmp_path):
    holder = a_process(tmp_path, "stays")
    holder.stdin.write("\n")
    holder.stdin.flush()
    assert holder.stdout.readline() == "within\n"
    holder.kill()
    holder.communicate()
    begun = time.monotonic()
    with only_one("compiles", tmp_path):
        assert time.monotonic() - begun < 20


def test_where_nothing_can_be_written_nobody_waits(tmp_path):
    (tmp_path / "__pycache__").write_text("no folder")
    with only_one("compiles", tmp_path), only_one("compiles", tmp_path):
        pass
