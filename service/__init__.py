"""The shell around the rules: runs them in real time and carries their messages.

asyncio, files, ports and their adapters belong here; no web framework does. This layer may import
`domain` and is imported by `api`.

Read `supervisor` first: it publishes the state of the robot 20 times a second.
"""
