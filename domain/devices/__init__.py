"""The computers of one robot, as its core sees them: who owns what, and whose word counts.

Read `settings.py` first. What the computers say to each other is the work of `domain.link`.
"""
