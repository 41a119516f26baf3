"""Warnings about valid models: constructs that the author probably did not intend."""
