"""Sources: the service itself reads signals from the computer, files, units and buses."""
