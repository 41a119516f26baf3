"""What is told of frames: which members are always there, and which may be left out."""

from api.http.schemas.stream import EventJson, GapJson, HelloJson, StateFrame

SCHEMA = StateFrame.model_json_schema(mode="serialization")


def test_what_has_not_changed_is_left_out_of_a_frame() -> None:
    assert set(SCHEMA["properties"]) - set(SCHEMA["required"]) == {
        "parts",
        "signals",
        "errors",
        "reactions",
        "devices",
        "this_device",
        "task",
        "vehicle",
        "holds",
        "emergency_stop",
    }


def test_what_is_left_out_is_not_null_except_for_a_task_that_is_over() -> None:
    nullable = [
        name for name, schema in SCHEMA["properties"].items() if {"type": "null"} in kinds(schema)
    ]

    assert nullable == ["task"]
    assert all("default" not in schema for schema in SCHEMA["properties"].values())


def test_every_other_message_is_whole() -> None:
    for model in (HelloJson, EventJson, GapJson):
        schema = model.model_json_schema(mode="serialization")

        assert set(schema["required"]) == set(schema["properties"])


def kinds(schema: dict[str, object]) -> list[object]:
    found = schema.get("anyOf", [])
    assert isinstance(found, list)
    return found
