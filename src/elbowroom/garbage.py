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


@contextmanager
def uncollected() -> Iterator[None]:
    """Within it no garbage is collected: that would look at every object of the program in the middle of a pass.

    What is left over is collected afterwards, since collecting is asked for as more is made. Several threads may be
    within it: who finds it off leaves it off.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
