from pathlib import Path

from service.storage.sqlite.places import Places


def test_files_of_the_log_are_found_in_order(tmp_path: Path) -> None:
    places = Places(tmp_path)
    places.make()
    places.make()
    for number in (10, 2, 1_000_000):
        places.log(number).touch()
    for name in ("000003.db-wal", "000004.db.new", "000005.db.broken-20260101T000000Z", "x.db"):
        (places.logs / name).touch()

    assert places.log_numbers() == [2, 10, 1_000_000]
    assert places.log(2).name == "000002.db"
    names = (places.state.name, places.lock.name, places.announced.name)
    assert names == ("state.db", "lock", "announced")
