"""The terminal monitor: what is known of a robot, and how a terminal shows it.

`store` folds what the service says into what is known; `picture` makes lines of that; both are
pure. `link` keeps up the contact, `watch` holds what it brought, and `screen` and `output` write.
"""
