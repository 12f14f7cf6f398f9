"""Viewers of a page without a screen, in a process of their own: `python -m elbowroom.evaluate.page.viewers`.

Good ones read as fast as they can; a stalled one connects and never reads. Read from standard input: one line of JSON
that says where, how many and for how long. Written to standard output: what the first good one got.
"""

import asyncio
import json
import os
import sys
import time
from collections.abc import Mapping
from typing import Any

from elbowroom.extras import package

NICE = 19
"""Their own work is none of the page's."""


async def watch(said: Mapping[str, Any]) -> dict[str, float]:
    """Views a page for a while.

    Args:
        said: host, good, stalled, seconds.
    """
    kept: list[tuple[str, float, bytes]] = []
    over = asyncio.Event()
    tasks = [_good(said["host"], number, over, kept) for number in range(said["good"])]
    tasks += [_stalled(said["host"], number, over) for number in range(said["stalled"])]
    running = [asyncio.create_task(task) for task in tasks]
    print("ready", flush=True)
    await asyncio.get_running_loop().run_in_executor(None, _wait, said["seconds"])
    over.set()
    for task in running:
        task.cancel()
    await asyncio.gather(*running, return_exceptions=True)
    return counted(kept)


def _wait(seconds: float) -> None:
    """Until standard input ends, or so long."""
    import select

    until_s = time.monotonic() + seconds
    while time.monotonic() < until_s:
        if select.select([sys.stdin], [], [], 0.2)[0] and not sys.stdin.readline():
            return


async def _good(host: str, number: int, over: asyncio.Event, kept: list[tuple[str, float, bytes]]) -> None:
    viser = package("viser")
    connect = package("websockets.asyncio.client").connect

    async def read(path: str, **options: Any) -> None:
        async with connect(f"ws://{host}{path}", origin=f"http://{host}", max_size=None, **options) as socket:
            async for content in socket:
                if number == 0:
                    raw = content.encode() if isinstance(content, str) else content
                    kept.append((path, time.monotonic(), raw))
                if over.is_set():
                    return

    subprotocol = f"viser-v{viser.__version__}"
    await asyncio.gather(read("/text"), read(f"/scene/viewer{number}", subprotocols=[subprotocol]))


async def _stalled(host: str, number: int, over: asyncio.Event) -> None:
    viser = package("viser")
    connect = package("websockets.asyncio.client").connect

    options = {"subprotocols": [f"viser-v{viser.__version__}"], "max_queue": 1, "origin": f"http://{host}"}
    async with (
        connect(f"ws://{host}/scene/stalled{number}", **options),
        connect(f"ws://{host}/text", max_queue=1, origin=f"http://{host}"),
    ):
        await over.wait()


def counted(kept: list[tuple[str, float, bytes]]) -> dict[str, float]:
    """Rates and bytes of what a viewer got, the first second apart, in which it gets all that stays.

    Args:
        kept: path, time and content of each message.
    """
    begin = min((when for _, when, _ in kept), default=0.0) + 1.0
    late = [one for one in kept if one[1] >= begin]
    seconds = max((when for _, when, _ in late), default=begin + 1e-9) - begin
    near = joints = 0
    for path, _, content in late:
        if path != "/text":
            updated = _updated(content)
            near += any(name.startswith("/near/") for name in updated)
            joints += any(name.startswith("/machine/") for name in updated)
    texts = sum(path == "/text" for path, _, _ in late)
    return {
        "seconds": seconds,
        "second_mb": sum(len(content) for _, _, content in late) / 1e6 / seconds,
        "space_hz": near / seconds,
        "joints_hz": joints / seconds,
        "text_hz": texts / seconds,
    }


def _updated(content: bytes) -> set[str]:
    """Names of the scene's nodes that a message of viser changes."""
    import msgspec.msgpack
    import zstandard

    packed = int.from_bytes(content[8:16], "little")
    inner = zstandard.ZstdDecompressor().decompress(
        content[16 : 16 + packed], max_output_size=int.from_bytes(content[:8], "little")
    )
    return {str(message.get("name", "")) for message in msgspec.msgpack.decode(inner)["messages"]}


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(NICE)
    print(json.dumps(asyncio.run(watch(json.loads(sys.stdin.readline())))), flush=True)
