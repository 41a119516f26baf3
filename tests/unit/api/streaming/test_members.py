from api.streaming.members import Members


class View:
    def __init__(self, text: str) -> None:
        self.text = text


def test_members_are_joined_to_an_object_with_their_names_escaped() -> None:
    members = Members[View](lambda view: view.text)

    assert members.text({"a": View("1"), 'b"': View("2")}) == '{"a":1,"b\\"":2}'


def test_a_view_that_is_the_same_is_not_made_again() -> None:
    made: list[View] = []

    def encode(view: View) -> str:
        made.append(view)
        return view.text

    members = Members[View](encode)
    first, second = View("1"), View("2")
    members.text({"a": first, "b": second})
    assert members.text({"a": first, "b": View("3")}) == '{"a":1,"b":3}'

    assert [view.text for view in made] == ["1", "2", "3"]


def test_what_was_learned_before_is_not_new() -> None:
    members = Members[View](lambda view: view.text)
    known, new = View("1"), View("2")
    members.learn([("a", known)])

    assert list(members.new_ones([("a", known), ("b", new)])) == [("b", new)]
