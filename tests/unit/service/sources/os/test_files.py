from pathlib import Path

import pytest

from service.sources.os.files import numbers_in, pressure_percent
from service.sources.source import SourceError

PRESSURE = """\
some avg10=12.34 avg60=5.00 avg300=1.00 total=123456
full avg10=1.00 avg60=0.00 avg300=0.00 total=1234
"""


def test_pressure_is_the_share_in_which_something_waited(tmp_path: Path) -> None:
    (tmp_path / "io").write_text(PRESSURE)

    assert pressure_percent(tmp_path / "io") == 12.34


def test_a_file_without_pressure_is_refused(tmp_path: Path) -> None:
    (tmp_path / "io").write_text("full avg10=1.00\n")

    with pytest.raises(SourceError, match="no pressure"):
        pressure_percent(tmp_path / "io")


def test_a_table_has_a_number_for_each_key(tmp_path: Path) -> None:
    (tmp_path / "cpu.stat").write_text("usage_usec 100\nuser_usec 60\n")

    assert numbers_in(tmp_path / "cpu.stat") == {"usage_usec": 100, "user_usec": 60}
