"""The event log over restarts: the newest events from memory, earlier ones from the journal."""
