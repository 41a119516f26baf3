"""A file with its tag, compressed for who can read that."""

import gzip

import pytest
from fastapi import Request

from api.http.page.page_file import KEEP, PageFile, answer_with, reads_gzip
from tests.support.http_robot import http_scope

FILE = PageFile.of(b"body{}" * 100, "text/css", compressed=True)


def request(**headers: str) -> Request:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return Request(http_scope("GET", "/", **named))


def test_a_file_is_sent_compressed_to_who_accepts_that() -> None:
    packed = answer_with(FILE, request(accept_encoding="gzip, br"), KEEP)
    plain = answer_with(FILE, request())

    assert gzip.decompress(bytes(packed.body)) == plain.body == FILE.content
    assert packed.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in plain.headers
    assert packed.headers["vary"] == plain.headers["vary"] == "Accept-Encoding"
    assert packed.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert plain.headers["cache-control"] == "no-cache"


def test_a_file_that_is_not_compressed_is_the_same_for_all() -> None:
    file = PageFile.of(b"{}", "application/json")

    answer = answer_with(file, request(accept_encoding="gzip"))

    assert answer.body == b"{}"
    assert "vary" not in answer.headers
    assert "content-encoding" not in answer.headers


@pytest.mark.parametrize("known", ['"{}"', 'W/"{}"', '"other", W/"{}"'])
def test_a_file_that_the_browser_has_is_not_sent_again(known: str) -> None:
    tag = FILE.etag.removeprefix('W/"').removesuffix('"')

    answer = answer_with(FILE, request(if_none_match=known.format(tag)))

    assert (answer.status_code, answer.body) == (304, b"")
    assert answer.headers["etag"] == FILE.etag


def test_a_file_that_has_changed_is_sent() -> None:
    assert answer_with(FILE, request(if_none_match='W/"other"')).status_code == 200


@pytest.mark.parametrize(
    ("accepted", "reads"),
    [
        ("gzip", True),
        ("br, GZIP ; q=0.5", True),
        ("", False),
        ("br", False),
        ("gzip;q=0", False),
        ("gzip; q=0.000, br", False),
        ("x-gzip", False),
    ],
)
def test_gzip_is_for_who_names_it(accepted: str, *, reads: bool) -> None:
    assert reads_gzip(request(accept_encoding=accepted)) is reads
