"""The audit trail of service calls, as of requests over HTTP."""

from dataclasses import replace
from http import HTTPStatus

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import WriteRecord
from service.ros.interface.endpoints import Fields, OfferedService
from service.supervisor import Supervisor

METHOD = "CALL"
"""Stands in the audit trail where HTTP has its method."""


def audited(supervisor: Supervisor, service: OfferedService) -> OfferedService:
    """Return a service whose calls are recorded with their caller and outcome.

    The outcome is written as the status that HTTP answers: 200, 409 for a response without success,
    422 for an invalid request, 504 if the caller did not wait for the end.

    Args:
        supervisor: Takes the records.
        service: Changes something.
    """

    async def call(request: Fields, caller: Actor) -> Fields:
        status = HTTPStatus.GATEWAY_TIMEOUT
        try:
            response = await service.call(request, caller)
            is_done = response.get("success", True)
            status = HTTPStatus.OK if is_done else HTTPStatus.CONFLICT
        except PilothouseError:
            status = HTTPStatus.UNPROCESSABLE_ENTITY
            raise
        finally:
            address = caller.address or caller.label
            record = WriteRecord(METHOD, service.name, status.value, address, caller)
            supervisor.submit(record)
        return response

    return replace(service, call=call)
