"""The web application: one page and one socket, for those who know the token."""

import asyncio
import hmac
import ipaddress
from collections.abc import Collection
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

import msgspec
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from overcooked_bench.human.server.messages import MOST_BYTES, MessageError, parse
from overcooked_bench.human.server.page.written import play_page, study_page
from overcooked_bench.human.server.playing import Page
from overcooked_bench.human.server.visit import Hall

MOST_VISITS = 64
"""Open pages at the same time."""
_MOST_UNSENT = 256
"""Messages that wait for a page; one that takes none any more is left."""
_HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_POLICY, _BUSY, _TOO_LONG, _NOT_TEXT = 1008, 1013, 1009, 1003  # RFC 6455, section 7.4.1
_GONE = (WebSocketDisconnect, RuntimeError)
"""What starlette raises if a page has been closed."""


def make_app(hall: Hall, token: str, hosts: Collection[str] = ()) -> Starlette:
    """Makes the application.

    Args:
        hall: Where people come in.
        token: What the address of the page ends with.
        hosts: Names by which the server may be called besides IP addresses and localhost; any other name is that of a
            foreign page (DNS rebinding).
    """
    house, visits = hall.house, hall.visits

    async def page(request: Request) -> Response:
        if why := _refusal(request, token, hosts):
            return PlainTextResponse(why, 403, _HEADERS)
        if hall.log is None:
            offers = {name: house.cast.offers(name) for name in house.terms.layouts}
            content = await asyncio.to_thread(play_page, house.terms, offers, house.kept is not None)
        else:
            content = await asyncio.to_thread(study_page, house.terms, hall.log.study)
        return HTMLResponse(content, headers=_HEADERS)

    async def socket(connection: WebSocket) -> None:
        foreign = connection.headers.get("origin") not in _origins(connection)
        if foreign or _refusal(connection, token, hosts):
            await connection.close(_POLICY)
            return
        await connection.accept()
        if len(visits) >= MOST_VISITS:
            await connection.close(_BUSY, f"{MOST_VISITS} pages are open; come back later")
            return
        unsent: asyncio.Queue[dict[str, Any]] = asyncio.Queue(_MOST_UNSENT)
        stuck = asyncio.Event()

        def say(message: dict[str, Any]) -> None:
            try:
                unsent.put_nowait(message)
            except asyncio.QueueFull:
                stuck.set()

        visit = hall.enter(say)
        works = [_hear(connection, visit), _send(connection, unsent), stuck.wait()]
        tasks = [asyncio.ensure_future(work) for work in works]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            visits.discard(visit)
            visit.leave()
            for task in tasks:
                task.cancel()
            ended = await asyncio.gather(*tasks, return_exceptions=True)
            with suppress(*_GONE):
                await connection.close()
        for error in ended:
            if isinstance(error, Exception):
                raise error

    return Starlette(routes=[Route("/", page), WebSocketRoute("/socket", socket)])


async def _hear(connection: WebSocket, visit: Page) -> None:
    """Passes messages on until the page is closed."""
    while True:
        received = await connection.receive()
        if received["type"] == "websocket.disconnect":
            return
        text = received.get("text")
        if text is None or len(text.encode()) > MOST_BYTES:
            await connection.close(_NOT_TEXT if text is None else _TOO_LONG)
            return
        try:
            await visit.hear(parse(text))
        except MessageError as error:
            visit.say({"type": "error", "text": str(error)})


async def _send(connection: WebSocket, unsent: "asyncio.Queue[dict[str, Any]]") -> None:
    """Sends what is to be said until the page is gone."""
    with suppress(*_GONE):
        while True:
            await connection.send_text(msgspec.json.encode(await unsent.get()).decode())


def _refusal(connection: HTTPConnection, token: str, hosts: Collection[str]) -> str:
    """Says why somebody may not come in; nothing if they may."""
    host = urlsplit(f"//{connection.headers.get('host', '')}").hostname or ""
    if host != "localhost" and host not in hosts and not _is_address(host):
        return "this server is not known by that name; use the address that it printed"
    if not hmac.compare_digest(connection.query_params.get("token", "").encode(), token.encode()):
        return "the address needs the token that the server printed: http://.../?token=..."
    return ""


def _origins(connection: HTTPConnection) -> tuple[str, ...]:
    """The origins of this server's own pages."""
    host = connection.headers.get("host", "")
    return f"http://{host}", f"https://{host}"


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
