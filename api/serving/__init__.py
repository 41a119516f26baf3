"""`pilothouse serve`: runs supervisor and web server side by side."""
