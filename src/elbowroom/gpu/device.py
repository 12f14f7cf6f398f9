"""A GPU by numba-cuda, taught what our kernels need: they run on it as they stand, and round as the processor does.

Products and sums are not fused into one rounding: the code generator would do that by default, and bits would differ.
Square roots and divisions are the exact ones. Without a GPU, numba's simulator runs the same threads
(`NUMBA_ENABLE_CUDASIM=1`, set before numba is imported).
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import config

from elbowroom.errors import PackageError
from elbowroom.extras import package
from elbowroom.geometry.kernels.bits import lowest_bit

SIMULATED = bool(getattr(config, "ENABLE_CUDASIM", 0))
"""Whether numba runs threads of the GPU as threads of Python."""
THREADS = 64
"""Of a block."""


@cache
def cuda() -> Any:
    """`numba.cuda`, taught; or the simulator.

    Raises:
        PackageError: numba-cuda is not installed, or one that cannot be taught.
    """
    if not SIMULATED:
        package("numba_cuda")
    from numba import cuda as numba_cuda

    if not SIMULATED:
        try:
            _teach(numba_cuda)
        except (ImportError, AttributeError, KeyError) as error:
            raise PackageError(
                f"this numba-cuda is not as those that are known ({error}); install what extra cuda names"
            ) from error
    return numba_cuda


def launch(thread: Callable[..., None], threads: int, job: Any) -> None:
    """Runs threads and waits for their end.

    Args:
        thread: what each of them does, of `kernels.threads`.
        threads: how many, each with its number, `cuda.grid(1)`.
        job: what they share, one tuple; arrays in it are copied there and back.
    """
    blocks = -(-threads // THREADS)
    if blocks:
        _kernel(thread)[blocks, THREADS](job)
        cuda().synchronize()


@cache
def _kernel(thread: Callable[..., None]) -> Any:
    return cuda().jit(thread)


def _teach(numba_cuda: Any) -> None:
    """Adds what our kernels use and numba-cuda lacks, and takes fusing away."""
    import numba.cuda.cudadrv.nvvm as nvvm
    from numba.cuda import extending, ufuncs
    from numba.cuda.np import npyfuncs

    @extending.overload(lowest_bit, target="cuda")  # type: ignore[attr-defined]
    def _lowest_bit(word):  # type: ignore[no-untyped-def]
        return lambda word: np.int64(numba_cuda.ffs(word) - 1)

    known = ufuncs.ufunc_db()
    for function, emit in (
        (np.floor, npyfuncs.np_real_floor_impl),
        (np.ceil, npyfuncs.np_real_ceil_impl),
        (np.sqrt, npyfuncs.np_real_sqrt_impl),
    ):
        known[function] = {"f->f": emit, "d->d": emit}

    fusing = nvvm.compile_ir
    # an option of the decorator is asked for (github.com/NVIDIA/numba-cuda/pull/839)
    nvvm.compile_ir = lambda code, **options: fusing(code, **{**options, "fma": False})
