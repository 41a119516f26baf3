"""Scenarios in virtual time: the live code, fed with steps and sampled at intervals.

Read `simulation.py` first; `api/http/schemas/simulation.py` defines scenarios.
"""
