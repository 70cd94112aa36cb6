"""Runs the server until it is stopped."""

import secrets
import socket
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from overcooked_bench.agents.threads import one_thread
from overcooked_bench.errors import WrongUse
from overcooked_bench.human.server.house import House, Terms
from overcooked_bench.human.server.keeping import GamesFile
from overcooked_bench.human.server.offers import Cast
from overcooked_bench.human.study.log import StudyLog

LOOPBACK = "127.0.0.1"
THREADS = 8
"""Agents that are asked at the same time."""


class ServerError(WrongUse):
    """The server cannot run; says why."""


@dataclass(frozen=True)
class Place:
    """Where the server listens.

    Attributes:
        host: An address or name; only this machine by default.
        port: 0 takes a free one.
        token: What the address ends with; a new one if it is empty.
    """

    host: str = LOOPBACK
    port: int = 0
    token: str = ""


def serve(
    terms: Terms,
    cast: Cast,
    kept: str | Path | None,
    place: Place,
    say: Callable[[str], object],
    log: StudyLog | None = None,
) -> None:
    """Serves the page until Ctrl-C.

    Args:
        terms: How games are played.
        cast: With whom.
        kept: The games file for people who agree; None keeps nothing.
        place: Where it listens.
        say: Is shown the address of the page, once it can be opened.
        log: Of the study that it is for, if it is for one.

    Raises:
        ServerError: The extra `play` is not installed, or the address cannot be used.
        GamesError: The games file cannot be written.
    """
    try:
        import uvicorn

        from overcooked_bench.human.server.app import make_app
        from overcooked_bench.human.server.messages import MOST_BYTES
        from overcooked_bench.human.server.visit import Hall
    except ImportError as error:
        raise ServerError(
            f"playing in a browser needs the package {error.name}; pip install 'overcooked-bench[play]'"
        ) from None
    token = place.token or secrets.token_urlsafe(16)
    with listening(place) as listener, ThreadPoolExecutor(THREADS) as threads, one_thread():
        house = House(terms, cast, threads, None if kept is None else GamesFile(kept))
        for layout in terms.layouts if log is None else ():  # before anybody waits for it
            cast.offers(layout)
        config = uvicorn.Config(
            make_app(Hall(house, log), token, [place.host]),
            ws="websockets-sansio",
            ws_max_size=MOST_BYTES,
            log_level="warning",
            lifespan="off",
            timeout_graceful_shutdown=1,
        )
        name, port = place.host, listener.getsockname()[1]
        say(f"http://{f'[{name}]' if ':' in name else name}:{port}/?token={token}")
        uvicorn.Server(config).run(sockets=[listener])


def listening(place: Place) -> socket.socket:
    """Opens the socket that the server listens on.

    Raises:
        ServerError: The address cannot be used.
    """
    try:
        return socket.create_server(
            (place.host, place.port), family=socket.AF_INET6 if ":" in place.host else socket.AF_INET, backlog=128
        )
    except (OSError, OverflowError) as error:
        raise ServerError(f"{place.host}, port {place.port}: {error}; choose another --host or --port") from None
