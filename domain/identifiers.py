"""Identifiers that the core assigns; each kind counts from 1."""

from typing import NewType

ChangeId = NewType("ChangeId", str)
TaskId = NewType("TaskId", str)
GoalId = NewType("GoalId", int)
