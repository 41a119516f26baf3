"""A recorded robot in the monitor page: read-only, at any speed."""
