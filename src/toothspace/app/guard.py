"""Who is let in: a browser that has shown the token, under the name of this server, from its page.

Bodies are read after that, up to a size and within a time.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any, final
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]

LARGEST_BODY = 2 * 2**20
"""Of a request that is no upload. [byte]"""
BODY_TIME = 30.0
"""In which a body has to arrive; an upload has ten times as long. [s]"""
_HEADERS = {
    "cache-control": "no-store",
    "content-security-policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; frame-ancestors 'none'; "
    "form-action 'none'",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}
_ENTERED = (
    b"<!doctype html><html lang=en><meta charset=utf-8><title>toothspace</title>"
    b'<meta http-equiv=refresh content="0;url=/"><p><a href="/">toothspace</a>'
)


class BodyError(Exception):
    """A body is larger than allowed, or came too slowly."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


@final
class Guard:
    """Application that lets in whom it knows.

    Parameters
    ----------
    application : callable
        What those who are let in reach.
    hosts : set of str
        Values of the header ``Host`` under which this server is reached.
    largest_upload : int
        Body of an upload. [byte]
    """

    def __init__(self, application: Any, hosts: set[str], largest_upload: int) -> None:
        self._application, self._hosts = application, hosts
        self._largest_upload = largest_upload
        self.token = secrets.token_urlsafe(24)
        """Shown once, in the address that is opened first."""
        self._key = secrets.token_urlsafe(24)
        self._cookie = f"toothspace_{secrets.token_hex(4)}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] == "lifespan":
            await self._application(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        headers = {name.decode("latin-1"): v.decode("latin-1") for name, v in scope["headers"]}
        if not self._asked_by_this_page(scope["method"], headers):
            await _plain(send, 403, b"Refused: not asked under the name of this server.")
            return
        given = parse_qs(scope["query_string"].decode("latin-1"))
        token = given.get("token", [""])[0] if scope["path"] == "/" else ""
        if token and secrets.compare_digest(token.encode(), self.token.encode()):
            cookie = f"{self._cookie}={self._key}; Path=/; HttpOnly; SameSite=Strict"
            await _plain(send, 200, _ENTERED, "text/html; charset=utf-8", cookie)
            return
        if not self._knows(headers.get("cookie", "")):
            await _plain(send, 403, b"Open the address that 'toothspace app' has printed.")
            return
        upload = scope["method"] == "PUT" and scope["path"].startswith("/api/files/")
        most = self._largest_upload if upload else LARGEST_BODY
        length = headers.get("content-length", "0")
        if not (length.isascii() and length.isdigit()) or len(length) > 12 or int(length) > most:
            await _plain(send, 413, b"The body is larger than allowed.")
            return
        limited = _limited(receive, most, BODY_TIME * (10.0 if upload else 1.0))
        try:
            await self._application(scope, limited, _with_headers(send))
        except BodyError as refused:
            await _plain(send, refused.code, b"The body is too large, or came too slowly.")

    def _asked_by_this_page(self, method: str, headers: dict[str, str]) -> bool:
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in self._hosts:
            return False
        if origin is not None and origin != f"http://{host}":
            return False
        changes = method not in {"GET", "HEAD"}
        if changes and origin is None:
            return False
        site = headers.get("sec-fetch-site", "same-origin")
        return site in {"same-origin", "none"} or (
            not changes and headers.get("sec-fetch-mode") == "navigate"
        )

    def _knows(self, cookie: str) -> bool:
        try:
            found = SimpleCookie(cookie).get(self._cookie)
        except CookieError:
            return False
        given = "" if found is None else found.value
        return secrets.compare_digest(given.encode(), self._key.encode())


def _limited(receive: Receive, most: int, longest: float) -> Receive:
    """Reading of a body that ends where it grows too large or takes too long."""
    until, size, whole = time.monotonic() + longest, 0, False

    async def read() -> MutableMapping[str, Any]:
        nonlocal size, whole
        if whole:
            return await receive()
        try:
            message = await asyncio.wait_for(receive(), max(until - time.monotonic(), 0.0))
        except TimeoutError as error:
            raise BodyError(408) from error
        size += len(message.get("body", b""))
        if size > most:
            raise BodyError(413)
        whole = not message.get("more_body", False)
        return message

    return read


def _with_headers(send: Send) -> Send:
    async def sent(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            given = {name.lower() for name, _ in message["headers"]}
            own = [(n.encode(), v.encode()) for n, v in _HEADERS.items() if n.encode() not in given]
            message = {**message, "headers": [*message["headers"], *own]}
        await send(message)

    return sent


async def _plain(
    send: Send, code: int, body: bytes, kind: str = "text/plain", cookie: str = ""
) -> None:
    headers = {**_HEADERS, "content-type": kind, "content-length": str(len(body))}
    if cookie:
        headers["set-cookie"] = cookie
    lines = [(name.encode(), value.encode()) for name, value in headers.items()]
    await send({"type": "http.response.start", "status": code, "headers": lines})
    await send({"type": "http.response.body", "body": body})
