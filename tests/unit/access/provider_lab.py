"""A station and a provider at which people sign in."""

from urllib.parse import parse_qsl, urlsplit

import httpx

from teachpath.access.access import Access
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.provider_sign_in import Answer, open_provider
from teachpath.access.settings import AuthSettings, OidcSettings
from teachpath.records import Subject
from tests.identity_provider import EmulatedProvider

NS = 10**9


PAGE = "https://robot.example/"


CLIENT_ADDRESS = "127.0.0.1"


NOW_NS = 10**9  # [s]


class Lab:
    """A station whose people sign in at a provider, and its clock."""

    def __init__(self, provider: EmulatedProvider, settings: OidcSettings) -> None:
        self.now, self.provider, self.people = float(NOW_NS), provider, MemoryPeople()
        provider.now = lambda: self.now
        self.access = Access(
            AuthSettings("oidc", session_idle=600.0),
            MemoryTokens(),
            self.people,
            lambda: round(self.now * NS),
            settings,
            open_provider("oidc", settings, lambda: self.now),
        )
        assert self.access.provider
        self.sign_ins = self.access.provider

    def visited(self) -> tuple[Answer, str]:
        """Begin, let the browser go to the provider, and return what it comes back with, and its secret."""
        address, secret = self.sign_ins.begin(PAGE, CLIENT_ADDRESS)
        with httpx.Client(verify=False) as browser:
            place = browser.get(address).headers["location"]
        found = dict(parse_qsl(urlsplit(place).query))
        return Answer(found["code"], found["state"], found.get("iss", "")), secret

    def sign_in(self) -> tuple[str, Subject]:
        return self.sign_ins.finish(*self.visited())
