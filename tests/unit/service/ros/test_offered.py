from service.ros.offered import MAX_PARTS, OfferedNames


def test_names_are_listed_with_their_types_and_those_of_parts_by_part() -> None:
    offered = OfferedNames(
        {
            "/serve_waypoints": "pilothouse_msgs/srv/StartTask",
            "/cancel_tasks": "std_srvs/srv/Empty",
            "/left/arm/get_mode": "system_modes_msgs/srv/GetMode",
            "/left/arm/change_mode": "system_modes_msgs/srv/ChangeMode",
        },
        {
            "/system_state": "pilothouse_msgs/msg/SystemState",
            "/left/arm/mode_event": "system_modes_msgs/msg/ModeEvent",
        },
        {"/pilothouse/checkpoints": "std_msgs/msg/String"},
    )

    assert list(offered.lines(["left/arm", "not-in-ros"])) == [
        "services: /cancel_tasks [std_srvs/srv/Empty],"
        " /serve_waypoints [pilothouse_msgs/srv/StartTask]",
        "publishes: /system_state [pilothouse_msgs/msg/SystemState]",
        "subscribes to: /pilothouse/checkpoints [std_msgs/msg/String]",
        "/left/arm: services change_mode, get_mode; publishes mode_event",
    ]


def test_what_a_part_does_not_have_is_said() -> None:
    offered = OfferedNames({"/a/get_mode": "t"}, {"/b/mode_event": "t"})

    assert list(offered.lines(["a", "b"])) == [
        "/a: services get_mode; publishes nothing",
        "/b: services none; publishes mode_event",
    ]


def test_the_list_of_a_large_robot_is_short() -> None:
    parts = [f"node_{number}" for number in range(1_000)]
    offered = OfferedNames({f"/{part}/get_mode": "t" for part in parts})

    lines = list(offered.lines(parts))

    assert len(lines) == MAX_PARTS + 1
    assert lines[-1] == "and 980 more parts, which offer the same"


def test_of_nothing_there_is_no_list() -> None:
    assert list(OfferedNames().lines(["a"])) == []
