"""Durable state, logs and history of one robot, behind the port `Journal`."""
