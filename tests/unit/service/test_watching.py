from service.watching import Watched


class _Bell(Watched):
    def ring(self) -> None:
        self._wake_watchers()


def test_each_watcher_hears_of_each_change() -> None:
    bell, heard = _Bell(), list[str]()

    with bell.watch(lambda: heard.append("one")), bell.watch(lambda: heard.append("two")):
        bell.ring()
        bell.ring()

    assert heard == ["one", "two", "one", "two"]


def test_who_left_hears_nothing_more() -> None:
    bell, heard = _Bell(), list[str]()
    with bell.watch(lambda: heard.append("gone")):
        pass

    bell.ring()

    assert heard == []


def test_who_leaves_by_an_error_is_forgotten_too() -> None:
    bell, heard = _Bell(), list[str]()
    try:
        with bell.watch(lambda: heard.append("gone")):
            raise ConnectionError
    except ConnectionError:
        pass

    bell.ring()

    assert heard == []
