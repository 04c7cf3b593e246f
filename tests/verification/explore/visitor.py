"""A visitor without a browser: asks for the page, comes back by its socket, clicks; and hears what it is sent."""

import json
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import httpx
import socketio

SOCKET = "/_nicegui_ws/socket.io"


class Visitor:
    """A page and its socket."""

    def __init__(self, address: str, text: str) -> None:
        self.address, self.text, self.heard = address, text, ""
        self.client = re.search(r"client_id': '([0-9a-f-]+)'", text)[1]
        self.socket = socketio.AsyncClient()
        self.socket.on("*", self._hear)

    def _hear(self, _, data):
        self.heard += json.dumps(data)

    async def connect(self, origin):
        """Come back by the socket, as a page of ``origin`` would."""
        query = f"client_id={self.client}&next_message_id=0&implicit_handshake=true&tab_id=tab&document_id=document"
        headers = {"Origin": origin} if origin else {}
        address = f"{self.address}?{query}"
        await self.socket.connect(address, headers, transports=["websocket"], socketio_path=SOCKET)

    async def click(self, label):
        """Click the button with a label."""
        button = rf'"(\d+)":{{"tag":"q-btn","props":{{[^}}]*"label":"{label}".*?"events":\[(.*?)\]}}'
        number, events = re.search(button, self.text).groups()
        listener = json.loads(f"[{events}]")[0]["listener_id"]
        sent = {"id": int(number), "client_id": self.client, "listener_id": listener, "args": []}
        await self.socket.emit("event", sent)

    async def hear(self, text):
        """Wait until a text has been sent; what was sent until then."""
        while text not in self.heard:
            await self.socket.sleep(0.02)
        return self.heard


async def get(address: str, query: str = "", **headers: str) -> httpx.Response:
    """The answer to a GET alone."""
    async with httpx.AsyncClient(timeout=60) as http:
        return await http.get(f"{address}{query}", headers=headers)


@asynccontextmanager
async def visiting(address: str, query: str = "") -> AsyncIterator[Visitor]:
    """A visitor who stays for the block."""
    found = Visitor(address, (await get(address, query)).text)
    try:
        await found.connect(address.rstrip("/"))
        yield found
    finally:
        await found.socket.disconnect()
