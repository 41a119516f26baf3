"""The `pilothouse` command and the terminal monitor."""
