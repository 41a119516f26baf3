"""Identifiers that the core gives out; each counts from 1."""

from typing import NewType

ChangeId = NewType("ChangeId", str)
TaskId = NewType("TaskId", str)
GoalId = NewType("GoalId", int)
