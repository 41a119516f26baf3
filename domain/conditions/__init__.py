"""Conditions: one line of text that is true, false or unknown, and can say why."""
