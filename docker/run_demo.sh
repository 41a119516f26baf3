#!/usr/bin/env bash
# Runs the demonstration: the example robot with simulated nodes, signals and vehicle, and its page.
# Ctrl-C or SIGTERM ends it. Only this machine can reach it; it asks for no token and keeps nothing.
#
#     docker/run_demo.sh [--here] [--build] [--base IMAGE] [--port PORT]
#
#   --here        without a container, with the `pilothouse` of this shell or of .venv
#   --build       build the image anew; without it, only if it is missing
#   --base IMAGE  build on this image instead of that of docker/Dockerfile
#   --port PORT   of the page; default 8000
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=runner.sh
. "$(dirname "${BASH_SOURCE[0]}")/runner.sh"

parse "--here --build --base --port" "$@"
[ ${#ARGUMENTS[@]} -eq 0 ] || die "unknown argument '${ARGUMENTS[0]}'; see --help"

if [ -n "$HERE" ]; then
    find_pilothouse .venv
    exec "$PILOTHOUSE" serve --port "$PORT" --data :memory:
fi
find_engine
provide pilothouse Dockerfile
echo "The page: http://localhost:$PORT/"
# Nobody else can reach the port, hence no token.
exec "$ENGINE" run --rm "${CONFINED[@]}" --publish "127.0.0.1:$PORT:8000" \
    pilothouse serve --host 0.0.0.0 --anonymous --data :memory:
