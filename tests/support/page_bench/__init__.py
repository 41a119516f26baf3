"""What the benches of the page need: a slow network, a robot that changes fast, and a browser."""
