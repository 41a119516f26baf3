"""Messages that were not taken in."""

from domain.link.drops import Drop, Drops


def test_they_are_counted_by_the_reason() -> None:
    drops = Drops()
    drops.count(Drop.OLD)
    drops.count(Drop.OLD)

    assert drops.counts[Drop.OLD] == 2
    assert drops.counts[Drop.SENDER] == 0
