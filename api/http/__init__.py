"""HTTP: routes, messages, problems, and the gates before them."""
