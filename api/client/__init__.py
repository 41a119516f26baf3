"""The client library for a running service, used by commands and the terminal monitor."""
