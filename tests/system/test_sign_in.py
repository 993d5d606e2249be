"""People sign in on the page in headless Chromium, see what they may not do, and sign out."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from teachpath.access.passwords import hash_password
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Capability, Person
from tests.contract import stations
from tests.identity_provider import CLIENT, SECRET, running
from tests.system.processes import Service
from tests.system.stop_places import stop_faults
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

PASSWORD = "four words put together"


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    data, now = tmp_path_factory.mktemp("station") / "data", time.time_ns()
    store = Store(StoreSettings(data_dir=str(data)))
    for name, role in (("anna", Capability.TEACH), ("olga", Capability.ADMINISTER)):
        store.people.add(Person(name, (role,), hash_password(PASSWORD, name), now, now))
    store.close()
    with Service(data, TEACHPATH_AUTH__MODE="token") as service:
        yield service


def test_a_person_signs_in_sees_what_is_missing_and_signs_out(browser: Any, service: Service) -> None:
    page = browser.new_page()
    page.set_default_timeout(1000 * HANG)
    page.goto(service.url)
    page.wait_for_selector("#sign-in form")
    assert stop_faults(page, "not signed in") == []
    assert not page.is_visible("main")
    assert not page.is_visible("#access-button")
    page.fill("#sign-in-name", "anna")
    page.fill("#sign-in-password", "wrong")
    page.click("#sign-in button")
    page.wait_for_function(
        "() => document.querySelector('#sign-in .error').textContent.includes('no one of this name')"
    )
    page.fill("#sign-in-password", PASSWORD)
    page.click("#sign-in button")
    page.wait_for_function("() => teachpath.state().connection === 'live'")
    assert page.inner_text("#identity").startswith("anna")
    assert not page.is_visible("#access-button")
    page.click("#tab-run")
    page.wait_for_selector("#panel-run .missing")
    assert "that needs the role “operate”" in page.inner_text("#panel-run .missing")
    page.click("#tab-edit")
    assert not page.is_visible("#panel-edit .missing")
    (cookie,) = page.context.cookies()
    assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
    assert page.evaluate("document.cookie") == ""
    page.reload()
    page.wait_for_function("() => teachpath.state().connection === 'live'")
    page.click("#identity button")
    page.wait_for_selector("#sign-in form")
    wait_until(lambda: not page.context.cookies(), "the session's cookie is gone")
    page.close()


def test_whoever_administers_makes_and_takes_back_people_and_tokens(browser: Any, service: Service) -> None:
    page = browser.new_page()
    page.set_default_timeout(1000 * HANG)
    page.on("dialog", lambda dialog: dialog.accept())
    page.goto(service.url)
    page.fill("#sign-in-name", "olga")
    page.fill("#sign-in-password", PASSWORD)
    page.click("#sign-in button")
    page.click("#access-button")
    page.wait_for_selector("#access li[data-key=anna]")
    page.fill("#person-name", "otto")
    page.select_option("#person-role", "operate")
    page.fill("#person-password", PASSWORD)
    page.click("text=Add the person")
    page.wait_for_selector("#access li[data-key=otto]")
    assert page.input_value("#person-password") == ""
    page.click("[data-new-password=otto]")
    page.fill("#other-password", "otto")
    page.evaluate("document.querySelector('#other-password').minLength = 0")  # the service judges, too
    page.click("text=Set the password")
    page.wait_for_function("() => document.querySelector('#access .error').textContent.includes('cannot be used')")
    page.click("[data-remove-person=otto]")
    page.wait_for_selector("#access li[data-key=otto]", state="detached")
    page.fill("#token-name", "cell-3")
    page.click("text=Make the token")
    token = page.inner_text("#access code")
    assert token.startswith("teachpath-")
    page.click("[data-revoke-token='cell-3']")
    page.wait_for_function("() => document.querySelector('[aria-label=tokens] li').textContent.includes('revoked')")
    page.click("#access-button")  # closes the popover
    page.click("#access-button")
    page.wait_for_selector("#access li[data-key^='cell-3']")
    assert token not in page.content()
    page.close()


def test_a_person_signs_in_at_a_provider(browser: Any, tmp_path: Path) -> None:
    secret = tmp_path / "client"
    secret.write_text(SECRET)
    secret.chmod(0o600)
    with running() as provider:
        client = {"name": "Lab", "issuer": provider.issuer, "client_id": CLIENT, "client_secret_file": str(secret)}
        oidc = client | {"administer": ["teachers"]}
        with stations.station(auth={"mode": "oidc"}, oidc=oidc) as station, stations.web_port(station) as port:
            page = browser.new_page()
            page.set_default_timeout(1000 * HANG)
            page.goto(f"http://127.0.0.1:{port}/?error=Call+0900&state=x")  # anybody can make such a link
            page.wait_for_selector("#sign-in .error:has-text('signed nobody in (error)')")
            assert not page.is_visible("#sign-in-password")
            provider.answer = {"code": "", "error": "access_denied"}
            page.click("text=Sign in with Lab")
            page.wait_for_selector("#sign-in .error:has-text('(access_denied)')")
            provider.answer = {}
            page.click("text=Sign in with Lab")
            page.wait_for_selector("#identity:has-text('anna')")
            page.wait_for_function("() => teachpath.state().connection === 'live'")
            assert page.url == f"http://127.0.0.1:{port}/"  # without the code
            (cookie,) = page.context.cookies()
            assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
            page.click("#access-button")
            page.wait_for_selector("#access li[data-key=anna]:has-text('1 session')")
            assert "They sign in at Lab and are added there" in page.inner_text("#access")
            assert not page.is_visible("#person-name")
            assert not page.is_visible("[data-new-password=anna]")
            assert page.is_visible("#token-name")  # programs have tokens here too
            page.click("#access-button")
            page.click("#identity button")
            page.wait_for_selector("text=Sign in with Lab")
            # The page says that the session is over as soon as its WebSockets have ended, before the answer is there.
            wait_until(lambda: not page.context.cookies(), "the session's cookie is gone")
            page.close()
