import pytest
from starlette.datastructures import Headers

from api.http.access import Access, bearer_of

TOKEN = "correct-horse-battery"


def headers(*values: str) -> Headers:
    return Headers(raw=[(b"authorization", value.encode("latin-1")) for value in values])


def test_where_no_token_is_set_everybody_is_let_in() -> None:
    access = Access.open()

    assert not access.required
    assert access.accepts("")
    assert access.accepts_header(Headers())
    assert access.accepts_header(headers("Bearer whatever"))


@pytest.mark.parametrize(
    "wrong", ["", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), f" {TOKEN}", "ä", "\ud800"]
)
def test_only_the_very_token_lets_in(wrong: str) -> None:
    access = Access.with_token(TOKEN)

    assert access.required
    assert access.accepts(TOKEN)
    assert not access.accepts(wrong)


@pytest.mark.parametrize(
    "given", [f"Bearer {TOKEN}", f"bearer {TOKEN}", f"BEARER  {TOKEN} ", f" Bearer {TOKEN}"]
)
def test_a_header_lets_in_however_its_scheme_is_written(given: str) -> None:
    assert Access.with_token(TOKEN).accepts_header(headers(given))


@pytest.mark.parametrize(
    "given",
    [
        (),
        ("",),
        (TOKEN,),
        ("Bearer",),
        ("Bearer ",),
        (f"Basic {TOKEN}",),
        ("Bearer wrong",),
        (f"Bearer {TOKEN}, Bearer {TOKEN}",),
        (f"Bearer {TOKEN}", f"Bearer {TOKEN}"),
        ("Bearer \xff",),
    ],
)
def test_a_header_that_says_it_otherwise_does_not(given: tuple[str, ...]) -> None:
    assert not Access.with_token(TOKEN).accepts_header(headers(*given))


def test_a_token_in_a_header_is_told_from_none() -> None:
    assert bearer_of(headers("Bearer wrong")) == "wrong"
    assert bearer_of(headers("Basic wrong")) is None


def test_nothing_shows_the_token() -> None:
    access = Access.with_token(TOKEN)

    assert TOKEN not in repr(access)
    assert "digest" not in repr(access)
