"""Requests that nobody thought of, made from the description of the interface.

Whatever comes: no request is answered with a fault, every answer is as described, and a request
that is refused has changed nothing. How many there were is printed in the end.
"""

import os
import sys
from collections.abc import Iterator
from http import HTTPStatus
from typing import Any

import pytest
import requests
import schemathesis
from hypothesis import HealthCheck, settings
from schemathesis import Case, CheckFunction
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import negative_data_rejection, positive_data_acceptance

from api.app import create_app
from tests.support import plausible_requests
from tests.support.live_robot import make_supervisor
from tests.support.storm import Storm

BASE_URL = "http://robot:8000"
LEFT_OUT: list[CheckFunction] = [
    # What is right by its form may name a part that there is not.
    positive_data_acceptance,
    # 504 is an answer: the outcome is not known. Everything else is checked in the test.
    not_a_server_error,
]
STOPS = ("/emergency_stop", "/holds/{owner}", "/signals", "/signals/{signal}", "/mock/{signal}")
"""What asks for a stop there is taken, also if its form is wrong otherwise."""
EXAMPLES = 300 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 4

plausible_requests.register()
document = create_app(make_supervisor(), allowed_hosts=[]).openapi()
schema = schemathesis.openapi.from_dict(plausible_requests.without_null_in_queries(document))
# A body or a query may be wrong, and too long to be looked at before that is known.
rejection = schema.config.checks.negative_data_rejection
rejection.expected_statuses = [*rejection.expected_statuses, "413", "414"]


@pytest.fixture(scope="module")
def storm(request: pytest.FixtureRequest) -> Iterator[Storm]:
    made = Storm()
    yield made
    made.close()
    capture = request.config.pluginmanager.getplugin("capturemanager")
    with capture.global_and_fixture_disabled():
        # Not to the standard output, which a worker of pytest-xdist does not pass on.
        print(f"\n{made.summary()}", file=sys.stderr)


@pytest.mark.timeout(600)  # One test is hundreds of requests.
@schema.parametrize()
@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck))
def test_a_request_of_any_kind_is_answered_as_described(case: "Case[Any]", storm: Storm) -> None:
    plausible_requests.name_what_there_is(case, storm.answers.total())
    before = storm.facts()
    kwargs = case.as_transport_kwargs(base_url=BASE_URL)
    prepared = requests.Request(**kwargs).prepare()

    answer, waited = storm.ask(prepared)

    assert answer.status_code < HTTPStatus.INTERNAL_SERVER_ERROR or (
        answer.status_code == HTTPStatus.GATEWAY_TIMEOUT and waited
    )
    if not answer.is_success and not waited:
        assert storm.facts() == before
    is_lenient = case.operation.path in STOPS
    left_out = [*LEFT_OUT, negative_data_rejection] if is_lenient else LEFT_OUT
    case.validate_response(answer, excluded_checks=left_out)
