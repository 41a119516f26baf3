import sys
from pathlib import Path

import pytest

from api.profiling.plot import NoMatplotlibError, check_plot, draw
from tests.support.profiled_runs import failed_run, ok_run


def test_the_picture_is_drawn_also_of_failed_runs(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "latency.png"

    draw([ok_run(1), ok_run(2, "GPS_LOST", persistence_s=15), failed_run(3)], file)

    assert file.read_bytes().startswith(b"\x89PNG")


def test_without_matplotlib_it_is_said_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)

    with pytest.raises(NoMatplotlibError, match=r"install pilothouse\[plot\]"):
        check_plot()
    with pytest.raises(NoMatplotlibError):
        draw([ok_run()], tmp_path / "latency.png")
