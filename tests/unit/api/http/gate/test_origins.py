"""Which origins are ours and which are allowed."""

import pytest

from api.http.gate.origins import AllowedOrigins, InvalidOriginError, is_same_origin


@pytest.mark.parametrize(
    "origin",
    ["http://grafana:3000", "HTTP://Grafana:3000", "https://app.foxglove.dev:443", "app://studio"],
)
def test_an_allowed_origin_is_recognised_however_it_is_written(origin: str) -> None:
    allowed = AllowedOrigins(
        ["http://grafana:3000", "https://app.foxglove.dev", "app://studio"],
    )

    assert origin in allowed


@pytest.mark.parametrize(
    "origin",
    [
        "http://grafana",
        "http://grafana:3001",
        "https://grafana:3000",
        "http://grafana:3000.evil.example",
        "http://grafana:3000, http://evil.example",
        "http://grafana:3000/",
        "http://user@grafana:3000",
        "null",
        "",
        "*",
    ],
)
def test_no_other_origin_is_allowed(origin: str) -> None:
    assert origin not in AllowedOrigins(["http://grafana:3000"])


@pytest.mark.parametrize("text", ["*", "null", "grafana", "http://", "http://*", "http://a/b", ""])
def test_what_is_no_origin_cannot_be_allowed(text: str) -> None:
    with pytest.raises(InvalidOriginError, match="expected a scheme"):
        AllowedOrigins([text])


@pytest.mark.parametrize(
    "origin", ["http://robot/, http://evil", "http://u@robot", "http://robot/x"]
)
def test_what_only_begins_like_ours_is_foreign(origin: str) -> None:
    assert not is_same_origin(origin, "robot")
