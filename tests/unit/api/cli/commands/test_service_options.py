"""What the options of a service say, whichever computer it is for."""

import argparse
from pathlib import Path

from api.cli.commands.service_options import add_service_options, serve_options
from api.serving.composition import ServeOptions
from api.serving.data_folder import USUAL


def parsed(*arguments: str) -> ServeOptions:
    parser = argparse.ArgumentParser()
    parser.set_defaults(model=Path("model.yaml"), robot=None)
    add_service_options(parser, data="a folder")
    return serve_options(parser.parse_args(arguments))


def test_without_options_it_is_as_usual() -> None:
    assert parsed() == ServeOptions(model=Path("model.yaml"), data=USUAL)


def test_where_a_computer_listens_for_the_others_can_be_said_more_than_once() -> None:
    options = parsed("--link", "tcp/127.0.0.1:1", "--link", "udp/127.0.0.1:1")

    assert options.link == ("tcp/127.0.0.1:1", "udp/127.0.0.1:1")
    assert not options.insecure_link


def test_a_link_without_certificates_has_to_be_asked_for() -> None:
    assert parsed("--insecure-link").insecure_link
