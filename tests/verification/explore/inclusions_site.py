"""A server with the tab of inclusions alone, for a browser; its argument is a folder, and it prints its address."""

import socket
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path

import uvicorn
from fastapi import FastAPI
from nicegui import ui

from verification.explore.common.folder import Folder
from verification.explore.common.streams import PictureStreams
from verification.explore.inclusions.page import InclusionsPage


def main(folder: Path) -> None:
    app, pool = FastAPI(), ThreadPoolExecutor(2)
    streams, css = PictureStreams(app), files("verification.explore").joinpath("page.css").read_text("utf-8")

    @ui.page("/")
    def visit() -> None:
        ui.add_css(css)
        InclusionsPage(Folder(folder), streams, pool)

    ui.run_with(app, tailwind=False, binding_refresh_interval=None, show_welcome_message=False)
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
    # It ends with the process that started it, whose end of the pipe is then closed.
    threading.Thread(target=lambda: (sys.stdin.read(), setattr(server, "should_exit", True)), daemon=True).start()
    print(f"http://127.0.0.1:{listening.getsockname()[1]}/", flush=True)
    server.run(sockets=[listening])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
