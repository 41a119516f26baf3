from service.ros.graph.graph import UnknownTypeError


def test_of_a_type_that_is_missing_it_is_said_what_to_install() -> None:
    error = UnknownTypeError("ackermann_msgs/msg/AckermannDrive")

    assert "ackermann_msgs/msg/AckermannDrive is not installed" in str(error)
    assert "install its package (ackermann_msgs)" in str(error)
    assert error.type_name == "ackermann_msgs/msg/AckermannDrive"
