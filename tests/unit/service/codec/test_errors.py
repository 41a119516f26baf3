"""An error of a record says where in it the fault is."""

from service.codec.errors import CodecError


def test_a_fault_is_told_with_the_way_that_leads_to_it() -> None:
    error = CodecError("expected a number, not null").inside("x_m").inside(3).inside("waypoints")

    assert error.message == "waypoints[3].x_m: expected a number, not null"
    assert (error.fault, error.place) == ("expected a number, not null", ("waypoints", 3, "x_m"))


def test_a_fault_of_the_record_itself_has_no_place() -> None:
    assert CodecError("this is no record").message == "this is no record"
