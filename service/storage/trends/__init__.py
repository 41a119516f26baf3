"""The history of signals: every reading counts in tiers that get coarser the longer they are kept.

    readings -> intake -> cascade of tiers -> blocks in `trends.db` -> history of a signal

The event loop only appends a reading to arrays (`intake`). All else happens in one thread
(`trends`): it groups the readings to rows of minimum, maximum, mean and the like (`rows`), packs
rows to blocks (`packing`), and writes these (`block_file`). A block of one tier is made of whole
blocks of the tier below, so what a killed process had not yet packed is derived again (`cascade`).
"""
