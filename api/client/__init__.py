"""The client of a running service, for commands and the terminal monitor."""
