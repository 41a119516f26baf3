"""The simulated robot, live and in virtual time; code for a real robot imports none of it."""
