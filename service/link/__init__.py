"""The link between the computers of one robot: a port, its adapters, and both ends of it."""
