"""A Modbus TCP server that a PLC polls. It answers what is true when it is asked, and refuses what would change it."""

import asyncio
import logging
from collections.abc import Callable
from typing import Any

from elbowroom.extras import package
from elbowroom.guard.registers import register_count, registers
from elbowroom.guard.watch import Said

READS = (3, 4)
"""Functions that are answered: read holding registers, read input registers; both say the same."""


class ModbusServer:
    """The output that is polled.

    Args:
        host: the address that it listens at.
        port: its port.
        motions: how many there are.
        ask: what is said now.

    Raises:
        InputError: more motions than one request can read.
        PackageError: pymodbus is not installed.
    """

    def __init__(self, host: str, port: int, motions: int, ask: Callable[[], Said]) -> None:
        self.name = f"Modbus TCP at {host}:{port}"
        self._address = host, port
        self._count = register_count(motions)
        self._ask = ask
        self._server: Any = None
        self._serving: asyncio.Task[None] | None = None
        self._simulator = package("pymodbus.simulator")
        self._refusal = package("pymodbus.constants").ExcCodes.ILLEGAL_FUNCTION
        self._made = package("pymodbus.server").ModbusTcpServer

    async def begin(self) -> None:
        """Listens.

        Raises:
            OSError: the port is taken, or the address is none of this computer's.
        """
        quiet = logging.getLogger("pymodbus_internal")
        quiet.addHandler(logging.NullHandler())
        quiet.propagate = False
        data = self._simulator.SimData(
            address=0, count=self._count, values=0, datatype=self._simulator.DataType.REGISTERS
        )
        device = self._simulator.SimDevice(id=0, simdata=[data], action=self._answer)
        self._server = self._made(device, address=self._address)
        if not await self._server.listen():
            host, port = self._address
            raise OSError(f"{host}:{port} cannot be listened at: taken, or no address of this computer")

    async def _answer(
        self, function: int, first: int, address: int, count: int, current: list[int], values: Any
    ) -> Any:
        """Called by pymodbus before each answer: puts what is said now into the registers, or refuses."""
        if function not in READS or values is not None:
            return self._refusal
        current[: self._count] = registers(self._ask())
        return None

    def say(self, said: Said) -> None:
        """Nobody is told who does not ask."""

    async def end(self) -> None:
        """Closes the port and all connections."""
        if self._server is not None:
            await self._server.shutdown()
