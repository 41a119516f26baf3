"""What each code of a finding means, and how to mend what it is about."""
