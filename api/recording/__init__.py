"""What was recorded, in files that other programs show."""
