"""The terminal monitor: shows the state of a robot on a terminal.

`store` folds the frames of the stream into the known state; `picture` makes lines of it; both are
pure. `api.client.link` keeps up the connection, `watch` holds the state, `screen` and `output`
write.
"""
