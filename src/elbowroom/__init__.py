"""How much elbow room does the machine have?

Several fixed depth cameras watch the space that a motorised machine shares with people. Their images become space
*seen to be free*; the machine's own body is taken out; before each movement the system says how far the machine can
go, and whether to go, slow down or stop, and why.

    frames -> what is the machine -> evidence -> free space -> motion checked -> verdict

Elbowroom is a supervisory layer that may only ever reduce motion. It is no certified safety function.
"""

import ast
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from elbowroom._kernel_cache import forget_stale_kernels

forget_stale_kernels()

_MODULE_OF = {
    name.name: line.module
    for line in ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
    if isinstance(line, ast.ImportFrom) and line.module is not None
    for name in line.names
}
"""By public name the module that it is at home in, as the stub beside this file says for type checkers."""
__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """Loads what is asked for when it is asked for, so that the command line starts at once."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'elbowroom' has no attribute {name!r}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)


class _Package(ModuleType):
    """Keeps `elbowroom.reconstruct` the function: Python binds a folder's name in its package once it is imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _MODULE_OF and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
