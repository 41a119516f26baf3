from service.storage.sqlite.batch import Batch, Checkpoint, Hole


def test_a_batch_is_empty_until_there_is_something_to_write() -> None:
    assert Batch().is_empty
    assert not Batch(steps=[b"step"]).is_empty
    assert not Batch(changes={("kept_hold", "a"): None}).is_empty
    assert not Batch(checkpoints=[Checkpoint(1, 0, b"")]).is_empty
    assert not Batch(hole=Hole(0, 1, 0, 0, 0, "full")).is_empty
