"""The number of the ROS 2 domain, which ROS itself hardly checks."""

import os

_DOMAINS = range(233)


def check_domain() -> None:
    """Reject a domain that ROS would misread, or that would abort the process.

    Raises:
        RuntimeError: ROS_DOMAIN_ID is not a whole number from 0 to 232.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "")
    try:
        # By the rules of C, as in rcl.
        domain = int(text or "0", base=0)
    except ValueError:
        domain = -1
    if domain not in _DOMAINS:
        raise RuntimeError(
            f"ROS_DOMAIN_ID must be a whole number from 0 to {_DOMAINS[-1]}, not {text!r:.40}"
        )
