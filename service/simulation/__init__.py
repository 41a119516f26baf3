"""The simulated robot, live and in virtual time; the path to a real robot imports none of it."""
