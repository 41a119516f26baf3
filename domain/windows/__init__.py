"""Statistics over sliding windows: what the readings of the last seconds say together."""
