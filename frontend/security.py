"""Response headers of the pages: nothing may be loaded from, or sent to, another origin."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import flask


def content_security_policy(script_hashes: Sequence[str]) -> str:
    """Scripts: our own files and the few inline ones that Dash writes, by hash. Styles: Mantine and Plotly set them
    from script, so they need 'unsafe-inline'. Blobs and data URLs are how Plotly saves a picture."""
    directives = {
        "default-src": "'self'",
        "script-src": " ".join(["'self'", *script_hashes]),
        "style-src": "'self' 'unsafe-inline'",
        "img-src": "'self' data: blob:",
        "font-src": "'self' data:",
        "connect-src": "'self'",
        "worker-src": "'self' blob:",
        "object-src": "'none'",
        "base-uri": "'self'",
        "form-action": "'self'",
        "frame-ancestors": "'none'",
    }
    return "; ".join(f"{name} {value}" for name, value in directives.items())


def add_headers(server: flask.Flask, script_hashes: Callable[[], Sequence[str]]) -> None:
    """`script_hashes` is asked with each page: Dash adds its own inline scripts when the first request comes in."""

    @server.after_request
    def secure(response: flask.Response) -> flask.Response:
        if response.mimetype == "text/html":
            response.headers.setdefault("Content-Security-Policy", content_security_policy(script_hashes()))
        response.headers.setdefault("X-Content-Type-Options", "nosniff")
        response.headers.setdefault("Referrer-Policy", "same-origin")
        return response
