"""What is wrong with how a service was started."""


class MisuseError(Exception):
    """Options of the command contradict each other, or ask for what this machine does not have.

    The message says what to do.
    """
