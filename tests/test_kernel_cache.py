from elbowroom._kernel_cache import forget_stale_kernels


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
