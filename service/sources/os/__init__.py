"""The computer as a source: its processors, memory, disks, network, clock, groups and processes."""
