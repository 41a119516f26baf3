"""Runs the processes of nodes, as the core decides."""
