"""The least that FastAPI and uvicorn do: a GET, and a POST with a body that is checked.

`python -m tests.support.echo_app` serves it on a free port; benches measure it beside ours.
"""

import asyncio
import socket

import uvicorn
import uvloop
from fastapi import FastAPI
from pydantic import BaseModel


class Value(BaseModel):
    """A body with one number."""

    value: float


app = FastAPI()


@app.get("/livez")
async def livez() -> dict[str, str]:
    """Return something small."""
    return {"status": "ok"}


@app.post("/echo")
async def echo(given: Value) -> Value:
    """Return what was given."""
    return given


if __name__ == "__main__":
    listener = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, access_log=False, log_level="warning"))
    print(f"page  http://127.0.0.1:{listener.getsockname()[1]}/\nCtrl-C", flush=True)
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        runner.run(server.serve([listener]))
