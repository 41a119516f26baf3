from pathlib import Path

import httpx
import pytest

from api.profiling.own_service import NotServingError, own_service

DATA = ("--data", ":memory:")


async def test_it_serves_without_a_token_as_long_as_it_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Neither the token of another service nor packages of the current folder are for it.
    monkeypatch.setenv("PILOTHOUSE_TOKEN", "a-token-that-is-for-another-service")
    (tmp_path / "api").mkdir()
    (tmp_path / "api" / "__init__.py").write_text("raise SystemExit('foreign')")
    monkeypatch.chdir(tmp_path)
    async with httpx.AsyncClient(trust_env=False) as http:
        async with own_service(DATA, tmp_path / "service.log") as url:
            answer = await http.get(f"{url}/system_state")
            assert answer.json()["simulated"]

        with pytest.raises(httpx.ConnectError):
            await http.get(f"{url}/livez")


async def test_why_it_does_not_start_is_said(tmp_path: Path) -> None:
    model = tmp_path / "model.yaml"
    model.write_text("nothing: [", encoding="utf-8")

    with pytest.raises(NotServingError, match=rf"did not start:\n.*{model}:1:"):
        async with own_service((str(model), *DATA), tmp_path / "service.log"):
            pass
