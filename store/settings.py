"""Settings of the service, read once from environment variables `SLOWDRIFT_…` (docs/operations.md lists them)."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from solver.outcome import SlowdriftError

PREFIX = "SLOWDRIFT_"
LOOPBACK = ("127.0.0.1", "localhost", "::1")


class SettingsError(SlowdriftError):
    """An environment variable holds something it cannot hold."""


class Settings(BaseModel):
    """One attribute per variable: `lease_seconds` is SLOWDRIFT_LEASE_SECONDS."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    data_dir: Path = Path(".slowdrift")
    """Folder of the embedded database, the embedded broker and the logs."""
    database_url: str = ""
    """SQLAlchemy URL; empty: SQLite in the data folder."""
    broker_url: str = ""
    """redis://… or amqp://…; empty: files in the data folder."""
    queue_prefix: str = Field("slowdrift", pattern=r"^[A-Za-z0-9_-]{1,60}$")
    """Name before the queues, so that several installations can share a broker."""
    lease_seconds: float = Field(30.0, gt=0)
    """How long a task belongs to a worker that gives no sign."""
    heartbeat_seconds: float = Field(1.0, gt=0)
    """How often a worker renews the lease, reports progress and looks for a cancel."""
    checkpoint_seconds: float = Field(30.0, gt=0)
    """How often a long task saves where it is."""
    max_attempts: int = Field(3, ge=1, le=100)
    """How often a task may lose its worker before the run fails."""
    reconcile_seconds: float = Field(5.0, gt=0)
    """How often a worker looks for forgotten tasks."""
    stale_seconds: float = Field(15.0, gt=0)
    """How long a task may stay queued before its message is sent again."""
    worker_memory_mb: int = Field(2000, ge=100)
    """A worker process above this is replaced after its task."""
    task_memory_mb: int = Field(4000, ge=100)
    """A task that needs more is ended, and its run fails with that reason."""
    bem_memory_mb: int = Field(3000, ge=100)
    """A hydrodynamic job that would need more is refused; keep it below task_memory_mb."""
    task_timeout_seconds: float = Field(900.0, gt=0)
    """A task may take so long, or timeout_factor times its estimate if that is more."""
    timeout_factor: float = Field(20.0, ge=1)
    """See task_timeout_seconds."""
    preview_seconds: float = Field(1.0, gt=0)
    """How long POST /preview waits for an answer."""
    max_request_bytes: int = Field(2_000_000, ge=1000)
    """Largest request body, data sets apart."""
    max_data_bytes: int = Field(64_000_000, ge=1000)
    """Largest data set."""
    max_bundle_bytes: int = Field(256_000_000, ge=1000)
    """Largest file of a run that is imported."""
    allowed_hosts: str = ""
    """Host names the API answers to beside this machine's own, with commas; * for any."""
    accounts: Literal["auto", "on"] = "auto"
    """auto: people sign in as soon as there is an account; on: from the start."""
    secret: str = Field("", pattern=r"^(.{32,})?$", repr=False)
    """Key of the HMACs of tokens, 32 characters or more; empty: the file `secret` in the data folder."""
    session_hours: float = Field(336.0, gt=0, le=8760)
    """How long one stays signed in."""
    public_url: str = Field("", pattern=r"^(https?://[^/]+)?/?$")
    """Where people reach the service, for links and secure cookies; empty: as the request came in."""
    forwarded_allow_ips: str = ""
    """Addresses and networks of proxies, with commas, whose X-Forwarded-For and -Proto are believed; empty: none."""
    allow_no_login: bool = False
    """Without accounts, obey requests of other machines and of proxies, too."""
    oidc_issuer: str = Field("", pattern=r"^(https://[^/\s].*|http://(127\.0\.0\.1|localhost|\[::1\])(:\d+)?(/.*)?)?$")
    """OpenID Connect provider by which people may sign in; empty: none. http only on this machine."""
    oidc_client_id: str = ""
    """Our name at the provider."""
    oidc_client_secret: str = Field("", repr=False)
    """Our password at the provider; empty for a public client, which PKCE protects alone."""
    oidc_scopes: str = Field("openid email profile", pattern=r"^openid( [!#-\[\]-~]+)*$")
    """What is asked of the provider; `email` is needed, since accounts are found by address."""
    oidc_name: str = Field("your organisation", max_length=100)
    """The provider's name on the button of the sign-in page."""
    oidc_domains: str = ""
    """Domains of e-mail addresses, with commas, whose people get an account at their first sign-in; empty: none."""
    rate_per_minute: int = Field(6000, ge=0)
    """Requests of one key, session or (of strangers) address in a minute; 0: any number."""
    max_connections: int = Field(5000, ge=10)
    """Open connections of one API process; fewer where the system allows fewer open files."""
    max_connections_per_address: int = Field(500, ge=0)
    """Of them from one address; 0: any number. This machine and trusted proxies are not counted."""
    max_streams: int = Field(2500, ge=1)
    """Open event streams of one API process; at most half of its connections."""
    max_streams_per_caller: int = Field(100, ge=0)
    """Of them of one user, or of one address behind share links; 0: any number."""
    quota_streams: int = Field(1000, ge=0)
    """Of them of one team; 0: any number."""
    quota_running_runs: int = Field(0, ge=0)
    """Runs of one team that may be at work at a time, the others wait; 0: any number."""
    quota_queued_runs: int = Field(20_000, ge=0)
    """Runs of one team that may wait; 0: any number."""
    quota_stored_runs: int = Field(200_000, ge=0)
    """Runs of one team that may be stored; 0: any number."""
    quota_data_sets: int = Field(2000, ge=0)
    """Data sets and meshes of one team; 0: any number."""
    quota_data_bytes: int = Field(20_000_000_000, ge=0)
    """Bytes of them together; 0: any number."""
    retention_days: float = Field(0.0, ge=0)
    """Ended runs older than this are deleted unless they are pinned; 0: none ever."""
    metrics_token: str = Field("", repr=False)
    """What /metrics wants as `Authorization: Bearer …`; empty: it answers this machine only."""
    log_level: str = "INFO"
    """Level of the service's logs."""
    log_json: bool = False
    """Logs as one JSON object a line."""
    solver: str = "solver.run"
    """Module with run_chunk and merge; tests put a fake there."""

    @field_validator("forwarded_allow_ips")
    @classmethod
    def _are_networks(cls, names: str) -> str:
        """`*` is refused: with it any caller could give itself any address."""
        try:
            for name in names.split(","):
                ipaddress.ip_network(name.strip() or "127.0.0.1")
        except ValueError:
            text = f"{name.strip()!r} is no address and no network of a proxy, such as 127.0.0.1 or 10.0.0.0/24"
            raise ValueError(text) from None
        return names

    @model_validator(mode="after")
    def _is_a_whole_provider(self) -> Settings:
        if self.oidc_issuer and not self.oidc_client_id:
            raise ValueError("SLOWDRIFT_OIDC_ISSUER needs SLOWDRIFT_OIDC_CLIENT_ID")
        if self.oidc_issuer and not self.public_url:
            raise ValueError("SLOWDRIFT_OIDC_ISSUER needs SLOWDRIFT_PUBLIC_URL: the provider sends people back there")
        return self

    @classmethod
    def from_env(cls, environ: Mapping[str, str] | None = None) -> Settings:
        environ = os.environ if environ is None else environ
        given = {key.removeprefix(PREFIX).lower(): value for key, value in environ.items() if key.startswith(PREFIX)}
        given.setdefault("forwarded_allow_ips", environ.get("FORWARDED_ALLOW_IPS", ""))  # uvicorn's own name for it
        known = {key: value for key, value in given.items() if key in cls.model_fields and value != ""}
        try:
            return cls.model_validate(known)
        except ValidationError as error:
            faults = [
                ": ".join([*(f"{PREFIX}{str(n).upper()}" for n in one["loc"][:1]), one["msg"]])
                for one in error.errors()
            ]
            raise SettingsError("; ".join(faults)) from None

    def as_env(self) -> dict[str, str]:
        """The variables that make a child process read equal settings."""
        return {PREFIX + name.upper(): str(value) for name, value in self.model_dump().items()}

    @property
    def database(self) -> str:
        """URL with its driver: psycopg (version 3) for PostgreSQL."""
        url = self.database_url or f"sqlite:///{self.data_dir.absolute() / 'slowdrift.db'}"
        for plain in ("postgres://", "postgresql://"):
            if url.startswith(plain):
                return "postgresql+psycopg://" + url.removeprefix(plain)
        return url

    @property
    def behind_proxy(self) -> bool:
        """Whether requests reach the service through a proxy, by what was set."""
        return bool(self.public_url or self.forwarded_allow_ips)

    @property
    def hosts(self) -> list[str]:
        """Names to which the API answers: this machine's, the public one, and those that are set."""
        public = urlsplit(self.public_url).hostname
        named = [host.strip() for host in self.allowed_hosts.split(",") if host.strip()]
        return [*LOOPBACK, *([public] if public else []), *named]
