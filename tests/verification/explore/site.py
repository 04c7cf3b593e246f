"""The server of the page in a process of its own, and a visitor without a browser, who hears what he is sent."""

import json
import os
import re
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

import httpx
import socketio

COMMAND = [sys.executable, "-c", "from tissue.cli import main; main()", "explore", "--no-browser"]
ROOT = Path(__file__).parents[3]
SOCKET = "/_nicegui_ws/socket.io"


@contextmanager
def served(folder: Path, *arguments: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The address of a server of this folder, and its process, which is ended at the end."""
    free = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST")}
    process = subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        env=free | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        yield process.stdout.readline().strip(), process
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()


def cpu_ticks(pid: int) -> int:
    """CPU time of a process, all its threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


class Visitor:
    """A page and its socket."""

    def __init__(self, address: str, text: str) -> None:
        self.address, self.heard = address, ""
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
