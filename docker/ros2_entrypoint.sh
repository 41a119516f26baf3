#!/usr/bin/env bash
# Entry point of the image of Dockerfile.ros2: sources the ROS distribution, the interfaces of
# Pilothouse, and the workspace of the robot if one is mounted at /workspace; then runs the command.
# Not `set -u`: the setup files of ROS read variables that are not set.
# shellcheck source=/dev/null
set -e
. "/opt/ros/$ROS_DISTRO/setup.bash"
. /opt/interfaces/local_setup.bash
if [ -f /workspace/install/local_setup.bash ]; then
    . /workspace/install/local_setup.bash
fi
exec "$@"
