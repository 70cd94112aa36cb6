"""A real server in a thread, and pages that speak to it without a browser."""

import json
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import uvicorn
from websockets.sync.client import ClientConnection, connect

from overcooked_bench.human.server.app import make_app
from overcooked_bench.human.server.house import House, Terms
from overcooked_bench.human.server.keeping import GamesFile
from overcooked_bench.human.server.messages import MOST_BYTES
from overcooked_bench.human.server.offers import Cast
from overcooked_bench.human.server.playing import Page as PageOfServer
from overcooked_bench.human.server.serving import Place, listening
from overcooked_bench.human.server.visit import Hall
from overcooked_bench.human.study.log import StudyLog

TOKEN = "a-token-of-the-tests"
SHORT = Terms(("cramped_room",), pace=0.005, horizon=30, countdown=0.0)


class Running:
    """A server that runs."""

    def __init__(self, hall: Hall, port: int) -> None:
        self.hall, self.house, self.port = hall, hall.house, port
        self.address = f"http://127.0.0.1:{port}/?token={TOKEN}"

    def visits(self) -> set[PageOfServer]:
        """The open pages."""
        return self.hall.visits

    def page(self, **more: Any) -> AbstractContextManager["Page"]:
        """Connects as the page does."""
        return connected(self.port, **{"token": TOKEN, **more})


class Page:
    """What a page sends and hears."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection

    def send(self, kind: str, **more: Any) -> None:
        self.connection.send(json.dumps({"type": kind, **more}))

    def hear(self, *kinds: str) -> dict[str, Any]:
        """Waits for the next message of one of these kinds."""
        while True:
            message: dict[str, Any] = json.loads(self.connection.recv(timeout=60))
            if not kinds or message["type"] in kinds:
                return message

    def play(self, agree: bool = True, **wanted: Any) -> dict[str, Any]:
        """Agrees or not, and plays a game without touching a key, to its end."""
        self.send("consent", agree=agree)
        self.send("begin", **{"layout": "cramped_room", "seat": 0, "partner": "greedy", **wanted})
        return self.hear("end")


@contextmanager
def connected(port: int, token: str, name: str = "127.0.0.1", **more: Any) -> Iterator[Page]:
    """Connects to a server as a page of it does, or with another origin or name."""
    origin = more.get("origin", f"http://{name}:{port}")
    where = f"ws://{name}:{port}/socket?token={token}"
    with connect(where, origin=origin, proxy=None, open_timeout=60, address=("127.0.0.1", port)) as connection:
        yield Page(connection)


@contextmanager
def running(
    kept: Path | None = None, terms: Terms = SHORT, given: tuple[str, ...] = (), log: StudyLog | None = None
) -> Iterator[Running]:
    """Serves until the end of the block."""
    with listening(Place()) as listener, ThreadPoolExecutor(4) as threads:
        hall = Hall(House(terms, Cast(given), threads, None if kept is None else GamesFile(kept)), log)
        app = make_app(hall, TOKEN)
        config = uvicorn.Config(
            app, ws="websockets-sansio", ws_max_size=MOST_BYTES, log_level="warning", lifespan="off"
        )
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield Running(hall, listener.getsockname()[1])
        finally:
            server.should_exit = True
            thread.join()
