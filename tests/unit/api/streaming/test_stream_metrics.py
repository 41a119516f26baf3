"""What Prometheus is told of the stream."""

from fastapi import FastAPI

from api.app import create_app
from api.streaming.stream_metrics import StreamCollector
from api.streaming.stream_server import stream_server
from tests.support.live_robot import make_supervisor, running
from tests.support.websocket import WebSocketClient


def collected(app: FastAPI) -> dict[str, float]:
    families = StreamCollector(stream_server(app)).collect()
    return {sample.name: sample.value for family in families for sample in family.samples}


async def test_the_clients_of_the_stream_are_counted() -> None:
    supervisor = make_supervisor()
    app = create_app(supervisor, allowed_hosts=[])
    async with running(supervisor):
        async with WebSocketClient(app) as client:
            await client.frame()
            assert collected(app)["pilothouse_ws_clients"] == 1

        assert collected(app) == {
            "pilothouse_ws_clients": 0,
            "pilothouse_ws_dropped_total": 0,
            "pilothouse_ws_frames_skipped_total": 0,
        }


def test_the_service_offers_them_with_its_others() -> None:
    app = create_app(make_supervisor(), allowed_hosts=[])

    assert app.state.metrics.registry.get_sample_value("pilothouse_ws_clients") == 0
