"""The core and the end of the link that each computer of an arrangement runs."""
