"""The frame around every page: header with navigation, the page, the few stores that live as long as the tab."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, dcc, html, page_container

from frontend.components.attributes import hyphened
from frontend.theme import MANTINE

LINKS = (("Runs", "/"), ("New run", "/new"), ("Compare", "/compare"), ("Studies", "/studies"), ("Data", "/data"))


def shell(prefix: str) -> dmc.MantineProvider:
    """`prefix` is where the pages are mounted, with a slash at both ends."""
    return dmc.MantineProvider(
        id="mantine",
        theme=MANTINE,
        defaultColorScheme="auto",
        children=[
            dcc.Location(id="location", refresh="callback-nav"),
            dcc.Store(id="prefix", data=prefix),
            dcc.Store(id="live", data={}),
            dmc.NotificationContainer(id="notices", position="top-right", autoClose=6000),
            html.A("Skip to the page", href="#page", className="sd-skip"),
            dmc.AppShell(
                [_header(prefix), _navbar(prefix), dmc.AppShellMain([_away(), html.Div(page_container, id="page")])],
                id="shell",
                header={"height": 56},
                navbar={"width": 220, "breakpoint": "sm", "collapsed": {"mobile": True, "desktop": True}},
                padding="md",
            ),
        ],
    )


def _header(prefix: str) -> dmc.AppShellHeader:
    links = [dcc.Link(text, href=prefix + path.lstrip("/"), className="sd-nav-link") for text, path in LINKS]
    return dmc.AppShellHeader(
        dmc.Group(
            [
                dmc.Burger(id="burger", opened=False, hiddenFrom="sm", size="sm", **hyphened(aria_label="Navigation")),
                dcc.Link([_mark(), html.Span("Slowdrift")], href=prefix, className="sd-brand"),
                html.Nav(dmc.Group(links, gap="xs", visibleFrom="sm", ml="lg"), **hyphened(aria_label="Pages")),
                html.Div(id="account-corner", style={"marginLeft": "auto"}),
                dmc.ColorSchemeToggle(
                    lightIcon="☀",
                    darkIcon="☾",
                    variant="default",
                    size="lg",
                    id="scheme",
                    **hyphened(aria_label="Light or dark"),
                ),
            ],
            h="100%",
            px="md",
            gap="sm",
        )
    )


def _away() -> html.Div:
    """Shown by `assets/a-net.js` while requests do not get through."""
    words = "The server does not answer. What you write is kept in this browser; this page goes on when it is back."
    return html.Div(words, id="sd-away", hidden=True, role="status")


def _mark() -> html.Span:
    """Two waves, drawn by the style sheet."""
    return html.Span(className="sd-mark", **hyphened(aria_hidden="true"))


def _navbar(prefix: str) -> dmc.AppShellNavbar:
    links = [
        dmc.NavLink(label=text, href=prefix + path.lstrip("/"), id={"type": "nav-narrow", "to": path})
        for text, path in LINKS
    ]
    return dmc.AppShellNavbar(links, p="md")


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "navbar"),
        Output("shell", "navbar"),
        Output("burger", "opened"),
        Input("burger", "opened"),
        Input("location", "pathname"),
        State("shell", "navbar"),
    )
    app.clientside_callback(
        ClientsideFunction("slowdrift", "follow"),
        Output("live", "data"),
        Input("location", "pathname"),
        State("prefix", "data"),
    )


def notice(title: str, message: Any = "", colour: str = "marine") -> list[dict[str, Any]]:
    """What `notices.sendNotifications` takes: a message that leaves by itself."""
    return [{"action": "show", "id": title, "title": title, "message": message, "color": colour}]
