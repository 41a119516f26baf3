"""The token and the limits of a real service, from its environment and its robot file."""

import os
import signal
from pathlib import Path

import httpx
import pytest

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE
from tests.support.process import run, service

TOKEN = "correct-horse-battery"
RIGHT = {"Authorization": f"Bearer {TOKEN}"}


def children_of(process: int) -> list[int]:
    told = Path(f"/proc/{process}/task/{process}/children").read_text()
    return [int(child) for child in told.split()]


def test_a_service_with_a_token_may_be_reached_by_others_and_lets_in_who_has_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)
    with service("--host", "0.0.0.0") as running, httpx.Client(base_url=running.url) as http:
        assert "token needed" in running.greeting
        assert TOKEN not in running.greeting
        assert http.get("/livez").status_code == 200
        # On one connection: what was not read of a refused body is not taken for a request.
        assert http.post("/tasks", content=b"x" * 100_000).status_code == 401
        assert http.get("/system_state", headers=RIGHT).status_code == 200


def test_neither_its_output_nor_its_children_have_the_token(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)
    with service("--log-level", "debug") as running:
        httpx.get(f"{running.url}/system_state", headers=RIGHT)
        httpx.post(f"{running.url}/model/check", content="a: 1", headers=RIGHT)
        workers = [worker for child in children_of(os.getpid()) for worker in children_of(child)]
        assert workers
        for worker in workers:
            assert TOKEN.encode() not in Path(f"/proc/{worker}/environ").read_bytes()
        running.send_signal(signal.SIGTERM)
        _, _, complaints = running.ended()
    assert TOKEN not in complaints


def test_the_command_line_takes_the_token_of_its_environment_or_says_that_it_needs_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = tmp_path / "token"
    file.write_text(f"{TOKEN}\n")
    monkeypatch.setenv(FILE_VARIABLE, str(file))
    with service() as running:
        mode = ("mode", "actuation", "MODERATE", "--url", running.url)
        assert run(*mode)[0] == 0
        monkeypatch.delenv(FILE_VARIABLE)

        code, _, complaints = run(*mode)

    assert code == 1
    assert "rejected: a token is required" in complaints
    assert f"set {TOKEN_VARIABLE}" in complaints


def test_the_limits_of_the_robot_file_hold(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text("limits: {json_bytes: 1024, requests_per_s: 1}\n")
    with service("--robot", str(robot)) as running, httpx.Client(base_url=running.url) as http:
        assert http.put("/emergency_stop", content=b" " * 1_025).status_code == 413
        assert [http.get("/systems").status_code for _ in range(30)].count(429) > 0
        stop = {"engaged": True, "reason": "test"}
        assert http.put("/emergency_stop", json=stop).status_code == 200
