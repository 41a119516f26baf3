"""The job of analysing the errors of a robot; the worker runs it, since it may take seconds."""

from api.http.schemas.analysis import AnalysisJson
from domain.analysis.fault_trees import ErrorGraph, fault_trees


def analyse(graph: ErrorGraph) -> bytes:
    """Return the fault trees of a robot as JSON.

    Args:
        graph: Its errors; plain values, which can be pickled.
    """
    return AnalysisJson.of(fault_trees(graph)).model_dump_json().encode()
