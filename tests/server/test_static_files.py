"""How the page's files travel: small, remembered by browsers, and event streams untouched."""

from __future__ import annotations

import gzip
from collections.abc import Iterator

import pytest

from server.routes.pages import accepts_gzip, static_folder
from tests.server import odd_batches
from tests.server.server_case import Client, serving, settings_for


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server whose jobs end at once, and whose quiet event streams stay so for an hour."""
    settings = settings_for(tmp_path_factory.mktemp("server"), heartbeat_seconds=3600.0)
    with serving(settings, compute=odd_batches.finish) as client:
        yield client


@pytest.mark.parametrize(
    ("path", "file", "media_type"),
    [
        ("/", "index.html", "text/html; charset=utf-8"),
        ("/static/js/main.js", "js/main.js", "text/javascript; charset=utf-8"),
        ("/static/css/base.css", "css/base.css", "text/css; charset=utf-8"),
        ("/static/css/icon.svg", "css/icon.svg", "image/svg+xml"),
    ],
)
def test_texts_travel_compressed_and_are_the_files(
    client: Client, path: str, file: str, media_type: str
) -> None:
    plain = (static_folder() / file).read_bytes()
    answer = client.get(path, headers={"Accept-Encoding": "gzip"})
    assert answer.headers["content-encoding"] == "gzip"
    assert int(answer.headers["content-length"]) == len(gzip.compress(plain, mtime=0)) < len(plain)
    assert answer.content == plain
    assert answer.headers["vary"] == "Accept-Encoding"
    assert answer.headers["content-type"] == media_type
    bare = client.get(path, headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in bare.headers
    assert bare.content == plain
    # One cache may hold both: their tags differ.
    assert bare.headers["etag"] != answer.headers["etag"]


@pytest.mark.parametrize("encoding", ["gzip", "identity"])
def test_what_a_browser_has_is_not_sent_again(client: Client, encoding: str) -> None:
    known = {"Accept-Encoding": encoding}
    tag = client.get("/static/js/main.js", headers=known).headers["etag"]
    for header in (tag, f"W/{tag}", f'"older", {tag}', "*"):
        again = client.get("/static/js/main.js", headers={**known, "If-None-Match": header})
        assert again.status_code == 304
        assert again.content == b""
        assert again.headers["etag"] == tag
    other = client.get("/static/js/main.js", headers={**known, "If-None-Match": '"older"'})
    assert other.status_code == 200


def test_head_tells_the_same_without_the_file(client: Client) -> None:
    known = client.get("/static/js/main.js").headers
    answer = client.head("/static/js/main.js")
    assert answer.content == b""
    assert answer.headers["content-length"] == known["content-length"]
    assert answer.headers["etag"] == known["etag"]


@pytest.mark.parametrize(
    ("header", "taken"),
    [
        ("gzip, deflate, br", True),
        ("GZIP;q=0.5", True),
        ("br, *", True),
        ("gzip;q=0, *", False),
        ("gzip; q=none", False),
        ("identity", False),
        ("", False),
    ],
)
def test_a_browser_says_whether_it_takes_gzip(header: str, taken: bool) -> None:
    assert accepts_gzip(header) is taken


def test_event_streams_are_neither_compressed_nor_held_back(client: Client) -> None:
    with client.stream("GET", "/api/v1/events", headers={"Accept-Encoding": "gzip"}) as answer:
        assert "content-encoding" not in answer.headers
        # A buffer would keep the first words at least until the heartbeat: the client gives up.
        assert next(answer.iter_text()).startswith("retry:")
