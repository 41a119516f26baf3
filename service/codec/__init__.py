"""Values of the core as plain JSON and back: what is written down, and what computers exchange."""
