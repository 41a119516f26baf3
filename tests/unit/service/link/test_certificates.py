import shutil
import subprocess
from pathlib import Path

import pytest

from domain.computers import ComputerName
from domain.errors import InvalidValueError
from service.link.certificates import Certificates, check_certificates
from tests.support.certificates import SCRIPT, certificates_in, make_certificates

pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")

BASE, ARM = ComputerName("base"), ComputerName("arm")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_certificates(tmp_path_factory.mktemp("certificates"), BASE, ARM)


def refusal(files: Certificates, name: ComputerName = BASE) -> str:
    with pytest.raises(InvalidValueError) as refused:
        check_certificates(files, name)
    return refused.value.message


def openssl(*arguments: str, cwd: Path) -> str:
    done = subprocess.run(
        ["openssl", *arguments], cwd=cwd, check=True, capture_output=True, text=True, timeout=60
    )
    return done.stdout


@pytest.mark.parametrize("name", [BASE, ARM])
def test_a_computer_with_its_own_certificate_is_accepted(folder: Path, name: ComputerName) -> None:
    check_certificates(certificates_in(folder, name), name)


def test_the_certificate_of_another_computer_is_not(folder: Path) -> None:
    assert "is of 'arm', and this is 'base'" in refusal(certificates_in(folder, ARM))


def test_the_key_of_another_certificate_is_told(folder: Path) -> None:
    files = certificates_in(folder, BASE)._replace(key=str(folder / "arm.key"))

    assert refusal(files).endswith("key values mismatch")


def test_a_certificate_of_another_authority_is_told(folder: Path, tmp_path: Path) -> None:
    make_certificates(tmp_path, BASE)
    files = certificates_in(folder, BASE)._replace(ca=str(tmp_path / "ca.pem"))

    assert refusal(files).endswith("unable to get local issuer certificate")


def test_a_certificate_that_has_expired_is_told(folder: Path, tmp_path: Path) -> None:
    files = certificates_in(folder, BASE)
    request, expired = tmp_path / "request.pem", tmp_path / "expired.pem"
    openssl("req", "-new", "-key", files.key, "-subj", "/CN=base", "-out", str(request), cwd=folder)
    signed_by = ("-CA", "ca.pem", "-CAkey", "ca.key", "-days", "-1")
    openssl("x509", "-req", "-in", str(request), "-out", str(expired), *signed_by, cwd=folder)

    assert refusal(files._replace(certificate=str(expired))).endswith("certificate has expired")


def test_a_certificate_without_a_name_is_told(folder: Path, tmp_path: Path) -> None:
    files = certificates_in(folder, BASE)
    request, nameless = tmp_path / "request.pem", tmp_path / "nameless.pem"
    openssl("req", "-new", "-key", files.key, "-subj", "/O=me", "-out", str(request), cwd=folder)
    signed_by = ("-CA", "ca.pem", "-CAkey", "ca.key", "-days", "1")
    openssl("x509", "-req", "-in", str(request), "-out", str(nameless), *signed_by, cwd=folder)

    assert "is of '', and this is 'base'" in refusal(files._replace(certificate=str(nameless)))


@pytest.mark.parametrize("file", ["ca", "certificate", "key"])
def test_a_file_that_is_missing_is_named(folder: Path, file: str) -> None:
    files = certificates_in(folder, BASE)._replace(**{file: "/nowhere/file.pem"})

    assert "/nowhere/file.pem" in refusal(files)
    assert refusal(files).endswith("No such file or directory")


@pytest.mark.parametrize("file", ["ca", "certificate"])
def test_a_file_that_is_no_certificate_is_named(folder: Path, file: str) -> None:
    files = certificates_in(folder, BASE)._replace(**{file: str(folder / "base.key")})

    assert str(folder / "base.key") in refusal(files)


# --- the script that makes them ----------------------------------------------------------------


def test_the_script_keeps_what_is_there_and_adds_a_computer(tmp_path: Path) -> None:
    make_certificates(tmp_path, BASE)
    before = (tmp_path / "base.pem").read_bytes(), (tmp_path / "ca.pem").read_bytes()

    make_certificates(tmp_path, BASE, ARM)

    assert ((tmp_path / "base.pem").read_bytes(), (tmp_path / "ca.pem").read_bytes()) == before
    check_certificates(certificates_in(tmp_path, ARM), ARM)


def test_keys_are_for_their_owner_only(folder: Path) -> None:
    modes = {file.name: file.stat().st_mode & 0o777 for file in folder.iterdir()}

    assert modes == {
        "ca.pem": 0o644,
        "ca.key": 0o600,
        "base.pem": 0o644,
        "base.key": 0o600,
        "arm.pem": 0o644,
        "arm.key": 0o600,
    }


def test_certificates_are_valid_for_a_computer_whose_clock_is_years_behind(folder: Path) -> None:
    shown = openssl("x509", "-in", "base.pem", "-noout", "-startdate", cwd=folder)

    assert shown.strip() == "notBefore=Jan  1 00:00:00 2000 GMT"


def test_a_computer_cannot_make_another_one(folder: Path) -> None:
    shown = openssl("x509", "-in", "base.pem", "-noout", "-ext", "basicConstraints", cwd=folder)

    assert "CA:FALSE" in shown


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "usage"),
        (["{folder}"], "usage"),
        (["{folder}", "Base"], "'Base' is not the name of a computer"),
        (["{folder}", "a/b"], "'a/b' is not the name of a computer"),
        (["{folder}", "ca"], "'ca' is the name of the files of the authority"),
    ],
)
def test_the_script_says_what_it_needs(tmp_path: Path, arguments: list[str], said: str) -> None:
    given = [argument.format(folder=tmp_path) for argument in arguments]

    done = subprocess.run([SCRIPT, *given], capture_output=True, text=True, timeout=60, check=False)

    assert done.returncode == 2
    assert said in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_script_adds_nothing_without_the_key_of_the_authority(tmp_path: Path) -> None:
    make_certificates(tmp_path, BASE)
    (tmp_path / "ca.key").unlink()

    done = subprocess.run(
        [SCRIPT, tmp_path, ARM], capture_output=True, text=True, timeout=60, check=False
    )

    assert done.returncode == 2
    assert "ca.key is missing" in done.stderr


@pytest.mark.skipif(shutil.which("shellcheck") is None, reason="shellcheck is not installed")
def test_the_script_has_no_faults_that_a_linter_finds() -> None:
    done = subprocess.run(["shellcheck", SCRIPT], capture_output=True, text=True, check=False)

    assert done.stdout == ""
