"""What viser's threads queue reaches the page, whenever they queue it."""

from __future__ import annotations

import asyncio
import threading

import pytest

from server.viewer.guard import start_server, stop_server


def test_what_is_queued_as_the_sender_lies_down_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    """After its look at the event, before it waits: a wake-up lost there was lost for ever."""
    server = start_server()
    event = type(server._websock_server._broadcast_buffer.message_event)()
    stop_server(server)

    async def lie_down() -> None:
        loop = asyncio.get_running_loop()
        looks = iter([True])

        def look() -> asyncio.AbstractEventLoop:
            if next(looks, False):
                other = threading.Thread(target=event.set)  # as viser queues a message
                other.start()
                other.join()
                loop.call_soon_threadsafe(event.set)  # and asks the loop to send it
            return loop

        monkeypatch.setattr(event, "_get_loop", look)
        await asyncio.wait_for(event.wait(), 10.0)

    asyncio.run(lie_down())
