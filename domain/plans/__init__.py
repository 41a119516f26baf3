"""Plans: in which order the parts of a system change, and how long that takes."""
