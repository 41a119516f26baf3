"""Measures how fast the supervisor reacts, and analyses what was measured."""
