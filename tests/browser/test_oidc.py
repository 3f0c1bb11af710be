"""Signing in and out by OpenID Connect on the pages, at a real provider."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import uvicorn

from cli.serve import compose_app
from store import migrations
from store.database import Database
from store.models import DEFAULT_TEAM
from store.repositories.accounts import AccountRepository
from store.repositories.teams import TeamRepository
from store.settings import Settings
from tests.access.test_oidc import provider
from tests.service.running import free_port, wait_until

from .conftest import WIDE, Browser, Page, playwright_api

pytestmark = [pytest.mark.browser, pytest.mark.slow]
expect = playwright_api.expect


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """A service with one account and a provider."""
    port = free_port()
    public = f"http://127.0.0.1:{port}"
    with provider(tmp_path, public) as issuer:
        settings = Settings(
            data_dir=tmp_path / "data", public_url=public, oidc_issuer=issuer, oidc_client_id="slowdrift",
            oidc_client_secret="a secret of the test's own", oidc_name="Example Ltd",
        )  # fmt: skip
        settings.data_dir.mkdir()
        database = Database(settings.database)
        migrations.upgrade(database)
        with database.write() as session:
            user = AccountRepository(session).add("ada@x.org", "Ada", None, True)
            TeamRepository(session).join(DEFAULT_TEAM, user.id, "owner")
        database.close()
        server = uvicorn.Server(uvicorn.Config(compose_app(settings, port), port=port, log_level="warning"))
        thread = threading.Thread(target=server.run, daemon=True)
        thread.start()
        wait_until(lambda: server.started, 60)
        yield public
        server.should_exit = True
        thread.join(30)


@pytest.fixture
def page(chromium: Browser, address: str) -> Iterator[Page]:
    context = chromium.new_context(viewport=WIDE, base_url=address)
    context.set_default_timeout(60_000)
    yield context.new_page()
    context.close()


def enter(page: Page, login: str) -> None:
    """From the first page to the provider, through its forms, and back."""
    page.goto("/app/")
    page.get_by_role("link", name="Sign in with Example Ltd").click()
    page.locator("input[name=login]").fill(login)
    page.locator("input[name=password]").fill("any")
    page.locator("button[type=submit]").click()
    page.get_by_role("button", name="Continue").click()


def test_in_and_out(page: Page) -> None:
    enter(page, "a-1/ada@x.org/verified")
    page.wait_for_url(re.compile(r"/app/$"))
    expect(page.get_by_role("link", name="Ada")).to_be_visible(timeout=60_000)
    page.goto("/app/account")
    page.get_by_role("button", name="Sign out").first.click()
    page.wait_for_url(re.compile("/session/end"))  # the provider asks whether its own session ends, too
    page.get_by_role("button", name=re.compile("Yes")).click()
    page.wait_for_url(re.compile("/app/sign-in"))
    page.goto("/app/account")
    page.wait_for_url(re.compile("/app/sign-in"))


def test_who_is_refused_reads_why(page: Page) -> None:
    enter(page, "b-1/bob@x.org/verified")
    page.wait_for_url(re.compile(r"/app/sign-in\?oidc=unknown$"))
    expect(page.get_by_text("There is no account for you yet.")).to_be_visible(timeout=60_000)
    expect(page.get_by_role("link", name="Sign in with Example Ltd")).to_be_visible(timeout=60_000)
