import pytest

from service.sources.source import SourceError, from_extra, reason_of


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            FileNotFoundError(2, "No such file or directory", "/sys/x"),
            "No such file or directory (/sys/x)",
        ),
        (OSError(121, "Remote I/O error"), "Remote I/O error"),
        (SourceError("no process is named camera"), "no process is named camera"),
        (ValueError(), "ValueError"),
        (RuntimeError("two\n  lines"), "two lines"),
        (RuntimeError("x" * 1_000), "x" * 200),
    ],
)
def test_an_error_is_told_in_one_line(error: Exception, words: str) -> None:
    assert reason_of(error) == words


def test_a_library_that_is_not_installed_says_how_to_install_it() -> None:
    with pytest.raises(SourceError, match=r"pip install 'pilothouse\[i2c\]'"), from_extra("i2c"):
        raise ModuleNotFoundError("No module named 'smbus2'")
