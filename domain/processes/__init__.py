"""The processes of nodes: when each is started, started again, and given up.

Whoever runs them (`service/processes`) reports; the decisions are here.
"""
