"""The terminal monitor: what is known of a robot, and how a terminal shows it.

`store` folds the frames of the stream into what is known; `picture` makes lines of that; both are
pure. `link` keeps up the contact, `watch` holds what it brought, and `screen` and `output` write.
"""
