"""What leads to the errors that stop the task."""

from fastapi import APIRouter, Response

from api.http.analysis_job import analyse
from api.http.dependencies import SupervisorDep, WorkerDep
from api.http.route_policy import Permission, policy
from api.http.schemas.analysis import AnalysisJson

router = APIRouter(tags=["model"])


@router.get("/analysis", response_model=AnalysisJson)
@policy(Permission.OBSERVE)
async def get_analysis(supervisor: SupervisorDep, worker: WorkerDep) -> Response:
    """Show the fault tree of each critical or fatal error: what raises it, alone or together.

    `unless` and times of the model are left out: no set is missing, and some may be harmless in a
    given situation. An error with too many sets has those of few errors, and says so.
    """
    content = await worker.call(analyse, supervisor.core.error_graph())
    return Response(content, media_type="application/json")
