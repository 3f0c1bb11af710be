"""The pages' one door to the service: its public REST API over HTTP, with the caller's cookie."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import quote

import flask
import httpx

from frontend.errors import ApiError, unreachable

API = "/api/v1"  # what the browser calls too, on the same origin
FORWARDED = ("cookie", "x-csrf-token", "authorization", "accept-language", "x-forwarded-for")
# x-forwarded-for: so that the service does not take the caller for a program of its own machine
# not Origin: the service judged it when the page called, and says so to us by the token (cli/serve.py)
YAML = {"content-type": "application/yaml"}
SHARE = "Slowdrift-Share"  # what a page opened by a share link sends with its callbacks (assets/a-net.js)
SHARED = ("/runs/", "/cases/")
_TOKEN = re.compile(r"[A-Za-z0-9_.-]{8,200}")


class Client:
    """A few verbs, and every failure as one `ApiError`."""

    def __init__(self, base_url: str | None = None, timeout: float = 30.0) -> None:
        self._base_url = base_url.rstrip("/") if base_url else None
        # trust_env would send loopback calls through a proxy named in the environment
        self._http = httpx.Client(timeout=timeout, trust_env=False)
        self._pool = ThreadPoolExecutor(max_workers=4, thread_name_prefix="pages-rest")

    def get(self, path: str, **params: Any) -> Any:
        return self._send("GET", path, params={k: v for k, v in params.items() if v is not None})

    def post(self, path: str, json: Any = None) -> Any:
        return self._send("POST", path, json=json)

    def post_yaml(self, path: str, text: str) -> Any:
        return self._send("POST", path, content=text.encode(), headers=YAML)

    def patch(self, path: str, json: Any) -> Any:
        return self._send("PATCH", path, json=json)

    def put(self, path: str, json: Any) -> Any:
        return self._send("PUT", path, json=json)

    def delete(self, path: str) -> Any:
        return self._send("DELETE", path)

    def channels(self, run_id: str, names: Iterable[str], **view: Any) -> dict[str, dict[str, Any]]:
        """The named channels, side by side; a name that the run does not have is left out. `view` goes to the service:
        points, from, to, seed, arc_length."""
        params = {key: value for key, value in view.items() if value is not None}
        origin, headers, base = self._origin(), self._headers(), shared(f"/runs/{run_id}")

        def fetch(name: str) -> tuple[str, dict[str, Any] | None]:
            url = f"{origin}{API}{base}/channels/{quote(name)}"
            return name, self._answer("GET", url, headers, missing_is_none=True, params=params)

        return {name: channel for name, channel in self._pool.map(fetch, names) if channel is not None}

    def _send(self, method: str, path: str, headers: dict[str, str] | None = None, **sent: Any) -> Any:
        merged = {**self._headers(), **(headers or {})}
        origin = self._origin()
        if method != "GET" and "slowdrift" in merged.get("cookie", ""):  # the service judged the page's own Origin
            who = self._answer("GET", f"{origin}{API}/me", merged)
            merged |= {"x-csrf-token": who["csrf_token"]} if who.get("csrf_token") else {}
        return self._answer(method, f"{origin}{API}{shared(path)}", merged, **sent)

    def _answer(
        self, method: str, url: str, headers: dict[str, str], missing_is_none: bool = False, **sent: Any
    ) -> Any:
        try:
            response = self._http.request(method, url, headers=headers, **sent)
        except httpx.HTTPError as error:
            raise unreachable(error) from error
        if missing_is_none and response.status_code == 404:
            return None
        if response.is_error:
            raise ApiError.from_response(response)
        return response.json() if response.content else None

    def _headers(self) -> dict[str, str]:
        return {name: flask.request.headers[name] for name in FORWARDED if name in flask.request.headers}

    def _origin(self) -> str:
        """The configured address, or the socket on which this very request came in (never the Host header)."""
        if self._base_url:
            return self._base_url
        environ = flask.request.environ
        host = environ["SERVER_NAME"]
        host = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host, f"[{host}]" if ":" in host else host)
        return f"http://{host}:{environ['SERVER_PORT']}"


def shared(path: str) -> str:
    """The path behind the share link by which the reader came, for runs and their cases; else the path itself."""
    token = flask.request.headers.get(SHARE, "")
    return f"/shared/{token}{path}" if _TOKEN.fullmatch(token) and path.startswith(SHARED) else path


def client() -> Client:
    """The client of the app that serves this request."""
    found: Client = flask.current_app.config["SLOWDRIFT_CLIENT"]
    return found


def attempt(call: Callable[[], Any]) -> tuple[Any, ApiError | None]:
    """The answer, or the error as a value: callbacks show it instead of failing."""
    try:
        return call(), None
    except ApiError as error:
        return None, error
