"""deploy/nginx.conf and deploy/Caddyfile before a real service: TLS, event streams at once, forwarded headers."""

from __future__ import annotations

import contextlib
import shutil
import ssl
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from sqlalchemy import select

from store import migrations
from store.database import Database
from store.models import DEFAULT_TEAM
from store.passwords import hash_password
from store.people import Audit
from store.repositories.accounts import AccountRepository
from store.repositories.teams import TeamRepository
from store.settings import Settings
from tests.service.running import a_case, end, free_port, start, wait_until

from .tools import DEPLOY, missing

pytestmark = pytest.mark.slow
NAME = "slowdrift.example.org"
PASSWORD = "correct horse battery"
CALLER = "127.0.0.2"
"""The address from which the tests call: not the one from which the proxy does."""


def certificate(folder: Path) -> None:
    subject = ["-subj", f"/CN={NAME}", "-addext", f"subjectAltName=DNS:{NAME}"]
    files = ["-keyout", str(folder / "privkey.pem"), "-out", str(folder / "fullchain.pem")]
    made = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", *subject, *files]
    subprocess.run(made, check=True, capture_output=True)


def nginx_files(folder: Path, upstream: int, http: int, https: int) -> Path:
    """The file as it is, but for ports and the certificate's place, in the frame that Debian's nginx.conf gives it."""
    certificate(folder)
    text = (DEPLOY / "nginx.conf").read_text()
    changes = {
        "127.0.0.1:8000": f"127.0.0.1:{upstream}",
        "listen 80;": f"listen 127.0.0.1:{http};",
        "listen [::]:80;": "",
        "listen 443 ssl": f"listen 127.0.0.1:{https} ssl",
        "listen [::]:443 ssl http2;": "",
        "/etc/ssl/slowdrift/": f"{folder}/",
    }
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    (folder / "slowdrift.conf").write_text(text)
    temporary = "".join(
        f"{name}_temp_path {folder}/{name};" for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    frame = f"""user root; daemon off; pid {folder}/nginx.pid; error_log {folder}/error.log; worker_processes 1;
events {{ worker_connections 256; }}
http {{ access_log off; {temporary} gzip on; include {folder}/slowdrift.conf; }}"""
    (folder / "nginx.conf").write_text(frame)
    return folder / "nginx.conf"


def caddy_files(folder: Path, upstream: int, http: int, https: int) -> Path:
    """The file as it is, with options before it that keep Caddy on this machine."""
    text = (DEPLOY / "Caddyfile").read_text()
    assert "127.0.0.1:8000" in text
    options = f"{{\nadmin off\nlocal_certs\nskip_install_trust\nhttp_port {http}\nhttps_port {https}\n"
    options += f"default_bind 127.0.0.1\nstorage file_system {folder}/caddy\n}}\n"
    (folder / "Caddyfile").write_text(options + text.replace("127.0.0.1:8000", f"127.0.0.1:{upstream}"))
    return folder / "Caddyfile"


COMMANDS = {
    "nginx": (nginx_files, ["nginx", "-c", "{file}", "-t"], ["nginx", "-c", "{file}"]),
    "caddy": (
        caddy_files,
        ["caddy", "validate", "--adapter", "caddyfile", "--config", "{file}"],
        ["caddy", "run", "--adapter", "caddyfile", "--config", "{file}"],
    ),
}


@dataclass
class Proxied:
    settings: Settings
    http: int
    https: int
    api: int
    certificates: Path

    def client(self, address: str = CALLER) -> httpx.Client:
        """Of a browser elsewhere, that reaches the proxy by its name and checks its certificate."""
        trust = ssl.create_default_context(cafile=str(self.certificates))
        transport = httpx.HTTPTransport(verify=trust, local_address=address)
        client = httpx.Client(transport=transport, base_url=f"https://127.0.0.1:{self.https}", timeout=60)
        client.headers.update({"host": self.host, "origin": f"https://{self.host}"})
        client.event_hooks["request"] = [lambda request: request.extensions.update(sni_hostname=NAME)]
        return client

    @property
    def host(self) -> str:
        return f"{NAME}:{self.https}"


def started(settings: Settings) -> None:
    """One account, as `slowdrift user add` makes it."""
    database = Database(settings.database)
    migrations.upgrade(database)
    with database.write() as session:
        user = AccountRepository(session).add("ada@x.org", "Ada", hash_password(PASSWORD), True)
        TeamRepository(session).join(DEFAULT_TEAM, user.id, "owner")
    database.close()


@pytest.fixture(scope="module", params=COMMANDS)
def proxied(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Proxied]:
    make, check, run = COMMANDS[request.param]
    if not shutil.which(request.param):
        missing(f"no {request.param}: apt-get install {request.param}")
    folder = tmp_path_factory.mktemp(request.param)
    api, http, https = free_port(), free_port(), free_port()
    file = make(folder, api, http, https)
    checked = subprocess.run([part.format(file=file) for part in check], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stderr
    settings = Settings(
        data_dir=folder / "data",
        public_url=f"https://{NAME}:{https}",
        forwarded_allow_ips="127.0.0.1",
        queue_prefix=f"proxies_{request.param}",
    )
    started(settings)
    with contextlib.ExitStack() as stack:
        service = start(settings, "serve", "--port", str(api), "--workers", "0", "--no-pages", "--log", "here")
        stack.callback(end, service)
        with (folder / "proxy.log").open("w") as log:
            proxy = subprocess.Popen([part.format(file=file) for part in run], stdout=log, stderr=log)
        stack.callback(end, proxy)
        root = folder / "caddy" / "pki" / "authorities" / "local" / "root.crt"
        trusted = folder / "fullchain.pem" if request.param == "nginx" else root
        place = Proxied(settings, http, https, api, trusted)
        wait_until(lambda: answers(place), 120)
        yield place


def answers(place: Proxied) -> bool:
    with contextlib.suppress(httpx.HTTPError, OSError), place.client() as client:
        return client.get("/readyz").status_code == 200
    return False


def enter(client: httpx.Client) -> httpx.Response:
    answer = client.post("/api/v1/auth/sign-in", json={"email": "ada@x.org", "password": PASSWORD})
    assert answer.status_code == 200, answer.text
    return answer


def test_plain_http_leads_to_https(proxied: Proxied) -> None:
    answer = httpx.get(f"http://127.0.0.1:{proxied.http}/app/runs?x=1", headers={"host": NAME})
    assert answer.status_code in (301, 308)
    assert answer.headers["location"].startswith(f"https://{NAME}")
    assert answer.headers["location"].endswith("/app/runs?x=1")


def test_tls_and_its_headers(proxied: Proxied) -> None:
    with proxied.client() as client:
        answer = client.get("/healthz")
        assert answer.status_code == 200
        assert "max-age=" in answer.headers["strict-transport-security"]
        assert client.get("/metrics").status_code == 404


def test_the_service_knows_that_it_is_reached_by_https(proxied: Proxied) -> None:
    with proxied.client() as client:
        cookies = enter(client).headers.get_list("set-cookie")
    assert [cookie.split("=")[0] for cookie in cookies] == ["__Host-slowdrift", "__Host-slowdrift-known"]
    assert all("secure" in cookie.lower() for cookie in cookies)


@pytest.mark.parametrize("forged", [{}, {"x-forwarded-for": "9.9.9.9"}, {"forwarded": "for=9.9.9.9"}])
def test_the_callers_address_is_the_proxys_word(proxied: Proxied, forged: dict[str, str]) -> None:
    """What a caller writes into the header itself does not get through."""
    with proxied.client() as client:
        client.headers.update(forged)
        enter(client)
    database = Database(proxied.settings.database)
    with database.read() as session:
        entry = session.scalars(select(Audit).where(Audit.action.contains("sign-in")).order_by(Audit.id.desc())).first()
    database.close()
    assert entry is not None
    assert entry.address == CALLER


def test_strangers_elsewhere_are_not_this_machine(proxied: Proxied) -> None:
    with proxied.client() as client:
        assert client.get("/api/v1/runs").status_code == 401


def test_events_arrive_at_once(proxied: Proxied) -> None:
    """No worker runs: the stream has no end, and what a buffer kept would not come."""
    with proxied.client() as client:
        enter(client)
        run = client.post("/api/v1/runs", json={"case": a_case("watched")}).json()["id"]
        with client.stream("GET", f"/api/v1/runs/{run}/events", timeout=30) as stream:
            assert stream.headers["content-type"].startswith("text/event-stream")
            lines = stream.iter_lines()
            assert "queued" in data_of(lines)
            with proxied.client() as other:
                enter(other)
                assert other.post(f"/api/v1/runs/{run}/cancel").status_code < 300
            assert "cancelled" in data_of(lines)


def data_of(lines: Iterator[str]) -> str:
    """The next event's data. The client's time limit is for each read, so a silent stream fails."""
    return next(line for line in lines if line.startswith("data:"))


def test_a_large_upload_gets_through(proxied: Proxied) -> None:
    """Larger than nginx' own limit of 1 MB: the service reads it, and says what is wrong with it."""
    with proxied.client() as client:
        enter(client)
        began = time.monotonic()
        answer = client.post("/api/v1/data-sets?name=large", files={"file": ("large.nc", b"\0" * 3_000_000)})
        assert answer.status_code == 422, (answer.status_code, time.monotonic() - began, answer.text)
