import signal
import subprocess
import sys

CODE = """\
import time
from api.profiling.end_with_parent import end_with_parent
end_with_parent()
print("began", flush=True)
time.sleep(50)
"""


def test_the_process_ends_when_the_pipe_to_its_parent_does() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", CODE], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        try:
            assert process.stdout.readline() == b"began\n"
            assert process.poll() is None
            process.stdin.close()
            assert process.wait(20) == -signal.SIGTERM
        finally:
            process.kill()
