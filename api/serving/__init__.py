"""What `pilothouse serve` runs: the robot and the web server as equals."""
