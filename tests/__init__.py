"""Tests of Pilothouse; `unit/` mirrors the source file by file.

This is the only `__init__.py` below the folder: one in `unit/domain/` would shadow `domain`.
"""
