"""What can be told of a robot before it runs: which errors lead to which."""
