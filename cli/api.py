"""The API process, started by the supervisor with a socket that is bound already."""

from __future__ import annotations

import argparse

from .lifeline import Pulse, hold_on

TURN = 0.0005
"""Seconds a thread may compute before another gets the interpreter. With Python's 0.005 the request that writes a
study of thousands of runs makes every read beside it wait at each of its own steps (benchmarks/reads_beside_studies.py).
"""

OTHER_FILES = 256
"""Open files of an API process beside connections: database, broker, files that are read."""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("api")
    parser.add_argument("--fd", type=int, required=True)
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--no-pages", action="store_true")
    parser.add_argument("--beside", action="store_true", help="beside the first, which does what is to be done once")
    parser.set_defaults(func=run_api)


def run_api(options: argparse.Namespace) -> int:
    import faulthandler
    import gc
    import socket
    import sys

    import uvicorn

    from api.connections import Connections, trusted_by
    from store.logs import configure
    from store.settings import Settings

    from .options import raise_open_files
    from .serve import compose_app

    hold_on()
    pulse = Pulse()
    faulthandler.enable()  # the supervisor ends a process that hangs by SIGABRT, and the log tells where it hung
    sys.setswitchinterval(TURN)
    gc.disable()
    settings = Settings.from_env()
    most = max(10, min(settings.max_connections, raise_open_files() - OTHER_FILES))
    settings = settings.model_copy(update={"max_connections": most})
    configure(settings.log_level, settings.log_json)
    app = compose_app(settings, options.port, pages=not options.no_pages, first=not options.beside)
    connections = Connections(
        most=most,
        most_per_address=settings.max_connections_per_address,
        trusted=trusted_by(settings.forwarded_allow_ips),
    )
    config = uvicorn.Config(
        app,
        http=connections.protocol,  # type: ignore[arg-type]
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=bool(settings.forwarded_allow_ips),  # believed from the proxies named, and from nobody else
        forwarded_allow_ips=settings.forwarded_allow_ips,
        timeout_graceful_shutdown=2,
        timeout_keep_alive=30,
    )
    gc.freeze()  # what is here now stays: to look it through again and again would stop all answers for 0.1 s each time
    gc.set_threshold(5_000, 5, 40)
    gc.enable()

    class Server(uvicorn.Server):
        async def on_tick(self, counter: int) -> bool:
            """Ten times a second, by the event loop that answers the requests."""
            pulse.beat()
            if counter % 10 == 0:
                connections.sweep()
            return await super().on_tick(counter)

    Server(config).run(sockets=[socket.socket(fileno=options.fd)])
    return 0
