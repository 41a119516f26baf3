import subprocess
import sys

from api.cli.parser import GROUPS, load, parser_for, places


def test_each_command_is_found_under_its_own_name() -> None:
    for name, place in places().items():
        assert load(place).name == name


def test_no_command_is_listed_twice() -> None:
    assert len(places()) == sum(map(len, GROUPS.values()))


def test_only_the_command_that_is_named_is_loaded() -> None:
    code = "import sys; from api.cli.parser import parser_for; parser_for(['hold', 'lunch'])"
    code += "; print(*(name for name in sys.modules if name.startswith('api.cli.commands.')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert set(done.stdout.split()) == {"api.cli.commands.command", "api.cli.commands.hold"}


def test_a_named_command_is_parsed_with_what_it_is_given() -> None:
    options = parser_for(["mode", "arm", "FAST"]).parse_args(["mode", "arm", "FAST"])

    assert (options.part, options.mode) == ("arm", "FAST")
