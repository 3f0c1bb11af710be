"""`slowdrift serve`: database, API with pages, workers, under one supervisor. The only place that composes them."""

from __future__ import annotations

import argparse
import importlib.util
import os
import shutil
from dataclasses import dataclass
from typing import Any

from store.settings import Settings

from .options import RefusedError, add_data_dir, bind, is_loopback, read_settings, refuse, say
from .supervisor import Child, Supervisor

MOST_PROCESSES = 64
API_SILENCE, WORKER_SILENCE = 20.0, 120.0
"""Seconds without a sign of life after which the supervisor replaces a process; a worker may be compiling."""
COUNTS = "PROMETHEUS_MULTIPROC_DIR"
"""Prometheus' own name for it."""
NO_LOGIN = (
    "{host} can be reached from other machines, and there are no accounts yet: whoever reaches it could read and "
    "delete everything. Make one with `slowdrift user add EMAIL`, or say --setup for a link at which to make it; bind to "
    "127.0.0.1; or say --allow-no-login where a network or proxy of yours keeps others out."
)

PROXY = (
    "The settings name a proxy ({names}), and there are no accounts yet: whoever reaches the proxy could read and delete "
    "everything. Make an account with `slowdrift user add EMAIL`, or say --setup for a link at which to make it; or say "
    "--allow-no-login where a network or proxy of yours keeps others out."
)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("serve", help="start the service")
    add_options(parser)
    parser.set_defaults(func=serve)


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--host", default="127.0.0.1", help="address to bind to (default: %(default)s)")
    parser.add_argument("--port", type=int, default=8000, help="0 takes any free one (default: %(default)s)")
    add_data_dir(parser)
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="runs at a time; 0: API only (default: 1)")
    parser.add_argument(
        "--api-processes", type=_count, default=1, metavar="N", help="processes that answer, on one port (default: 1)"
    )
    parser.add_argument("--no-pages", action="store_true", help="REST only")
    parser.add_argument("--allow-no-login", action="store_true", help="serve other machines though nobody signs in")
    parser.add_argument(
        "--public-url", metavar="URL", help="where people reach the service, such as https://sd.example.org"
    )
    parser.add_argument(
        "--forwarded-allow-ips", metavar="LIST", help="proxies whose forwarded headers are believed (default: none)"
    )
    parser.add_argument("--setup", action="store_true", help="print a link at which to make the first account")
    parser.add_argument("--log", choices=("files", "here"), default="files", help="logs into the data folder, or here")


def _count(text: str) -> int:
    number = int(text) if text.isdecimal() else 0
    if not 1 <= number <= MOST_PROCESSES:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes from 1 to {MOST_PROCESSES}")
    return number


@dataclass
class Service:
    """A started service, to be ticked and stopped by its owner."""

    url: str
    settings: Settings
    supervisor: Supervisor
    accounts: bool
    """Whether people have to sign in."""
    setup: str = ""
    """The link of --setup."""


def prepare(options: argparse.Namespace) -> Service:
    """Migrate, register the bundled data, bind, start the children. Raises RefusedError."""
    settings = read_settings(options.data_dir, _said(options))

    from store.bundled import register_bundled
    from store.database import Database
    from store.migrations import upgrade
    from store.repositories.entry import EntryRepository

    database = Database(settings.database)
    try:
        upgrade(database)
        register_bundled(database)
        with database.read() as session:
            known = EntryRepository(session).any_account()
    except Exception as error:
        raise RefusedError(f"the database cannot be prepared: {type(error).__name__}: {error}") from None
    finally:
        database.close()
    if not (known or options.setup or settings.allow_no_login or settings.accounts == "on"):
        _refuse_strangers(options, settings)
    if known or options.setup:
        settings = settings.model_copy(update={"accounts": "on"})
    listener = bind(options.host, options.port)
    port = listener.getsockname()[1]
    supervisor = Supervisor(
        _children(options, listener.fileno(), port),
        settings.as_env() | _counted_together(settings, options, port),
        settings.data_dir / "logs" if options.log == "files" else None,
    )
    supervisor.start()
    listener.detach()  # stays open here, so that connections wait while the API restarts
    shown = "127.0.0.1" if options.host in ("0.0.0.0", "::") else options.host
    url = f"http://{f'[{shown}]' if ':' in shown else shown}:{port}"
    setup = _setup_link(settings, url) if options.setup and not known else ""
    return Service(url, settings, supervisor, settings.accounts == "on", setup)


def _said(options: argparse.Namespace) -> dict[str, str]:
    """What options say, as variables."""
    said = {}
    if not is_loopback(options.host):
        said["SLOWDRIFT_ALLOWED_HOSTS"] = os.environ.get("SLOWDRIFT_ALLOWED_HOSTS") or "*"
    if options.allow_no_login:
        said["SLOWDRIFT_ALLOW_NO_LOGIN"] = "true"
    if options.public_url is not None:
        said["SLOWDRIFT_PUBLIC_URL"] = options.public_url
    if options.forwarded_allow_ips is not None:
        said["SLOWDRIFT_FORWARDED_ALLOW_IPS"] = options.forwarded_allow_ips
    return said


def _refuse_strangers(options: argparse.Namespace, settings: Settings) -> None:
    """Raises RefusedError where nobody has to sign in and others could reach the service."""
    if not is_loopback(options.host):
        raise RefusedError(NO_LOGIN.format(host=options.host))
    if settings.behind_proxy:
        names = [name for name in ("public_url", "forwarded_allow_ips") if getattr(settings, name)]
        raise RefusedError(PROXY.format(names=", ".join(f"SLOWDRIFT_{name.upper()}" for name in names)))


def _counted_together(settings: Settings, options: argparse.Namespace, port: int) -> dict[str, str]:
    """Where several API processes keep their counts, so that whichever is asked for metrics tells those of all."""
    if options.api_processes == 1:
        return {}
    folder = settings.data_dir / "metrics" / str(port)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return {COUNTS: str(folder)}


def _setup_link(settings: Settings, url: str) -> str:
    """Where to make the first account; good for a day, and once."""
    from store.database import Database
    from store.models import DEFAULT_TEAM
    from store.people import OWNER

    from .people import make_link

    database = Database(settings.database)
    try:
        with database.write() as session:
            link = make_link(session, settings, 1, team_id=DEFAULT_TEAM, role=OWNER, is_admin=True)
    finally:
        database.close()
    return link if settings.public_url else url + link


def _children(options: argparse.Namespace, descriptor: int, port: int) -> list[Child]:
    api = ["api", "--fd", str(descriptor), "--port", str(port)] + (["--no-pages"] if options.no_pages else [])
    children = [Child("api", api, (descriptor,), silence=API_SILENCE)]
    for number in range(2, options.api_processes + 1):
        children.append(Child(f"api-{number}", [*api, "--beside"], (descriptor,), silence=API_SILENCE))
    if options.workers > 0:
        children.append(Child("worker", ["worker", "--concurrency", str(options.workers)], silence=WORKER_SILENCE))
        children.append(Child("interactive", ["worker", "--queue", "interactive"], silence=WORKER_SILENCE))
        if importlib.util.find_spec("capytaine"):  # hydrodynamic jobs take long: in a process of their own
            children.append(Child("hydrodynamics", ["worker", "--queue", "hydrodynamics"], silence=WORKER_SILENCE))
    return children


def serve(options: argparse.Namespace) -> int:
    try:
        service = prepare(options)
    except RefusedError as error:
        return refuse(error)
    say(f"Slowdrift is at {service.url}/  (Ctrl-C ends it)")
    if service.setup:
        say(f"Make the first account at {service.setup}  (within a day)")
    if service.accounts:
        say("People sign in: `slowdrift user list` shows who.")
    elif is_loopback(options.host):
        say("No login: only this machine can reach it.")
    else:
        say("No login: whoever reaches this address may read and change everything.")
    if options.log == "files":
        say(f"Data and logs: {service.settings.data_dir}")
    try:
        service.supervisor.run()
    finally:
        service.supervisor.stop()
    return 0


def compose_app(settings: Settings, port: int, pages: bool = True, first: bool = True):  # type: ignore[no-untyped-def]
    """The API app with the pages mounted at /app, which talk to it over loopback like any other client.

    `first`: of the processes on this port, the one that does what is to be done once.
    """
    from starlette.responses import RedirectResponse

    from api.guard import session_token
    from api.main import create_app
    from api.nearness import MarkForwarded
    from store.tokens import csrf_token

    app = create_app(settings, reconcile=first)
    if not pages:
        return app
    try:
        from a2wsgi import WSGIMiddleware

        from frontend.app import create_app as create_pages
    except ImportError as error:
        say(f"The pages are not installed ({error}); REST only.")
        return app
    server = create_pages(f"http://127.0.0.1:{port}")

    def vouched(environ: Any, start_response: Any) -> Any:
        """The guard (api/guard.py) has judged the Origin under the name the browser used, and the pages call by
        another: so they show, for the session they act for, that it has been judged."""
        environ.pop("HTTP_ORIGIN", None)
        session = session_token(environ.get("HTTP_COOKIE", ""))
        environ["HTTP_X_CSRF_TOKEN"] = csrf_token(session) if session else ""
        return server(environ, start_response)

    app.mount("/app", MarkForwarded(WSGIMiddleware(vouched, workers=10)))  # type: ignore[arg-type]
    app.add_api_route("/", lambda: RedirectResponse("/app/"), include_in_schema=False)
    return app
