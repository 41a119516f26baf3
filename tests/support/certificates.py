"""Certificates for the computers of a robot, as the script of the project makes them."""

import subprocess
from pathlib import Path

from service.link.certificates import Certificates

SCRIPT = Path(__file__).resolve().parents[2] / "docker" / "make_certificates.sh"


def make_certificates(folder: Path, *names: str) -> Path:
    """Make an authority and certificates in a folder, or add to those that are there."""
    subprocess.run([SCRIPT, folder, *names], check=True, capture_output=True, timeout=60)
    return folder


def certificates_in(folder: Path, name: str) -> Certificates:
    """Return the files of one computer."""
    return Certificates(*(str(folder / file) for file in ("ca.pem", f"{name}.pem", f"{name}.key")))
