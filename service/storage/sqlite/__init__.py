"""The journal in a folder of SQLite files; `journal.py` is its front, on the event loop.

`folder.py` owns the files, in a thread of its own. Within this process only apsw may open them:
another SQLite library, or a plain `open`, would give up the locks when it closes them (POSIX).
"""
