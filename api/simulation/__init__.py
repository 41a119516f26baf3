"""Scenarios in virtual time: the robot's own code, fed with steps, and looked at now and then.

Read `simulation.py` first; what a scenario may say is in `api/http/schemas/simulation.py`.
"""
