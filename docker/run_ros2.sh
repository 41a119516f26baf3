#!/usr/bin/env bash
# Runs the robot of docs/ros2.md: the two example nodes as real ROS 2 nodes, and Pilothouse, which
# supervises them, with mocked signals. Ctrl-C or SIGTERM ends them all; so does the end of one.
#
#     docker/run_ros2.sh [--here] [--build] [--base IMAGE] [--port PORT]
#
#   --here        without containers, with the `pilothouse` of this shell or of .venv/ros2
#   --build       build the image anew; without it, only if it is missing
#   --base IMAGE  build on this image instead of that of docker/Dockerfile.ros2
#   --port PORT   of the page; default 8000
#
# The nodes are in the domain ROS_DOMAIN_ID, and on this machine only unless
# ROS_AUTOMATIC_DISCOVERY_RANGE says otherwise.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=runner.sh
. "$(dirname "${BASH_SOURCE[0]}")/runner.sh"

parse "--here --build --base --port" "$@"
[ ${#ARGUMENTS[@]} -eq 0 ] || die "unknown argument '${ARGUMENTS[0]}'; see --help"

SERVE=(serve --backend ros2 --mock-signals --port "$PORT" --data :memory:)
export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-0}"
export ROS_AUTOMATIC_DISCOVERY_RANGE="${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}"

# Each of these replaces its subshell, so that the signals of this script reach the program.
if [ -n "$HERE" ]; then
    find_pilothouse .venv/ros2
    node() { exec "$(dirname "$PILOTHOUSE")/python3" "$ROOT/examples/ros2/nodes/$1.py"; }
    supervisor() { exec "$PILOTHOUSE" "${SERVE[@]}"; }
else
    find_engine
    provide pilothouse-ros2 Dockerfile.ros2
    as_this_user
    # DDS needs the network, the shared memory and the user of its peers.
    RUN=("$ENGINE" run --rm "${CONFINED[@]}" "${USER_OPTIONS[@]}" --network host --ipc host
        --env ROS_DOMAIN_ID --env ROS_AUTOMATIC_DISCOVERY_RANGE)
    node() {
        exec "${RUN[@]}" --name "$(name_of "$1")" --volume "$ROOT/examples/ros2/nodes:/nodes:ro" \
            --entrypoint /opt/pilothouse/bin/ros2_entrypoint.sh \
            pilothouse-ros2 python3 "/nodes/$1.py"
    }
    supervisor() { exec "${RUN[@]}" --name "$(name_of supervisor)" pilothouse-ros2 "${SERVE[@]}"; }
fi
name_of() { echo "pilothouse-$$-$1"; }

# Ends them all. What does not end in time is killed: a middleware may hang when a peer has died.
PATIENCE_S=10
end_all() {
    local tries
    # shellcheck disable=SC2046
    kill $(jobs -p) 2>/dev/null || true
    for ((tries = 0; tries < 10 * PATIENCE_S; tries++)); do
        [ -n "$(jobs -pr)" ] || return 0
        sleep 0.1
    done
    echo "${0##*/}: killing what has not ended within $PATIENCE_S s" >&2
    # A container outlives the program that started it.
    [ -n "$HERE" ] || "$ENGINE" rm --force "$(name_of drive_base)" "$(name_of manipulator)" \
        "$(name_of supervisor)" >/dev/null 2>&1 || true
    # shellcheck disable=SC2046
    kill -KILL $(jobs -pr) 2>/dev/null || true
    wait
}

trap 'exit 130' INT
trap 'exit 143' TERM
trap end_all EXIT
node drive_base &
node manipulator &
supervisor &
wait -n
