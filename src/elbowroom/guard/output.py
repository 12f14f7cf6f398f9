"""Who is told what the machine may do: outputs, in the watchdog's process, so that they are told stop whoever dies."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from elbowroom.errors import InputError
from elbowroom.guard.watch import Said


class Output(Protocol):
    """Tells a receiver. A receiver takes silence for stop."""

    @property
    def name(self) -> str:
        """What it is and where, for messages."""

    async def begin(self) -> None:
        """Starts it.

        Raises:
            OSError, ElbowroomError: it cannot be started; one line says why.
        """

    def say(self, said: Said) -> None:
        """Told at every heartbeat and some times in each deadline; may raise, which stops all outputs."""

    async def end(self) -> None:
        """Ends it."""


class Callback:
    """Calls a Python function, in the watchdog's process, with what may be done.

    Args:
        where: "package.module:function" or "file.py:function"; it takes a `Said` and the motions' names, and does not
            wait for anything.
        motions: names of the motions, in the order of the words.

    Raises:
        InputError: there is no such function.
    """

    def __init__(self, where: str, motions: Sequence[str]) -> None:
        self.name = f"callback {where}"
        self._call = found(where)
        self._motions = tuple(motions)

    async def begin(self) -> None:
        """Nothing is to be started."""

    def say(self, said: Said) -> None:
        """Calls it."""
        self._call(said, self._motions)

    async def end(self) -> None:
        """Nothing is to be ended."""


def found(where: str) -> Callable[[Said, Sequence[str]], Any]:
    """The function that a text names.

    Args:
        where: "package.module:function" or "file.py:function".

    Raises:
        InputError: there is none.
    """
    module_name, _, name = where.rpartition(":")
    if module_name.endswith(".py"):
        path = Path(module_name)
        sys.path.insert(0, str(path.parent))
        module_name = path.stem
    try:
        function = getattr(import_module(module_name), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise InputError(f"callback {where}: {error}; write package.module:function") from None
    if not callable(function):
        raise InputError(f"callback {where}: is no function")
    return function


def outputs_of(told: Mapping[str, Any], ask: Callable[[], Said]) -> list[Output]:
    """The outputs that a watchdog is told to have.

    Args:
        told: `callback` (text or None), `modbus` ([host, port] or None), `motions` (names).
        ask: what is said now.

    Raises:
        InputError: a function that is not there, or too many motions.
        PackageError: pymodbus is not installed.
    """
    outputs: list[Output] = []
    if told["callback"] is not None:
        outputs.append(Callback(told["callback"], told["motions"]))
    if told["modbus"] is not None:
        from elbowroom.guard.modbus import ModbusServer

        host, port = told["modbus"]
        outputs.append(ModbusServer(host, port, len(told["motions"]), ask))
    return outputs
