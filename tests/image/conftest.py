"""One container, and one service in it, for all tests of the image."""

import os
from collections.abc import Iterator

import pytest

from tests.support.container import Container, ServiceInContainer, container, serving, why_not


@pytest.fixture(scope="session")
def box() -> Iterator[Container]:
    reason = why_not()
    if reason is not None:
        if os.environ.get("CI") == "true" and os.getuid() == 0:
            pytest.fail(f"CI has to test the image: {reason}")
        pytest.skip(reason)
    with container() as made:
        yield made


@pytest.fixture(scope="session")
def service(
    box: Container, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[ServiceInContainer]:
    with serving(box, tmp_path_factory.mktemp("secret")) as running:
        yield running
