import logging
from pathlib import Path

import pytest

from api.serving.failures import FAILED, complain_of, end_with, leaves, tell_failure
from domain.findings import Finding
from service.ros.graph.graph import GraphFailedError
from service.running import TaskFailedError


def test_the_failures_of_a_group_are_found_at_any_depth() -> None:
    first, second = ValueError("a"), KeyError("b")

    group = ExceptionGroup("all", [first, ExceptionGroup("some", [second])])

    assert [*leaves(group)] == [first, second]


def test_what_a_user_can_mend_is_told_without_a_traceback(
    caplog: pytest.LogCaptureFixture,
) -> None:
    failed = TaskFailedError("gateway")
    failed.__cause__ = GraphFailedError("the thread of ROS 2 failed")

    tell_failure(failed)

    [record] = caplog.records
    assert record.levelno == logging.CRITICAL
    assert record.getMessage() == "the thread of ROS 2 failed"
    assert record.exc_info is None


def test_a_fault_of_our_own_is_told_with_its_traceback(caplog: pytest.LogCaptureFixture) -> None:
    failed = TaskFailedError("supervisor")
    failed.__cause__ = ZeroDivisionError("division by zero")

    tell_failure(failed)

    assert "ZeroDivisionError: division by zero" in caplog.text


def test_a_complaint_has_its_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert end_with("there is no such file", 2) == 2

    assert "there is no such file" in capsys.readouterr().err


def test_each_finding_is_told_with_its_place(capsys: pytest.CaptureFixture[str]) -> None:
    finding = Finding("error", "SYNTAX", "it is wrong", line=3, column=5)

    assert complain_of(Path("robot.yaml"), [finding]) == FAILED

    assert "robot.yaml:3:5: error[SYNTAX]: it is wrong" in capsys.readouterr().err
