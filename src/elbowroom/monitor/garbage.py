"""What collections of garbage look through while a run goes on.

A process with compiled kernels holds some hundred thousand objects that stay. A full collection that looks through
all of them takes hundreds of milliseconds, in whatever pass it falls; one that looks at what came since takes a tenth
of one.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def what_is_here_stays() -> Iterator[None]:
    """Within it, collections leave alone what was there before; what comes is collected as ever."""
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
