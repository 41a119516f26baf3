#!/usr/bin/env bash
# Runs a command in the development image, in this checkout; default: all tests.
#
#     docker/run_dev.sh [--build] [--base IMAGE] [COMMAND...]
#
#   --build       build the image anew; without it, only if it is missing
#   --base IMAGE  build on this image instead of that of docker/Dockerfile.dev
#
# For example `docker/run_dev.sh bash`. The user has the ids of yours, so that files in the checkout
# stay yours, and may use sudo without a password.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=runner.sh
. "$(dirname "${BASH_SOURCE[0]}")/runner.sh"

parse "--build --base" "$@"

find_engine
as_this_user
IDS=()
# Root stays root: another user could not write a checkout of root.
if [ "$(id -u)" -eq 0 ]; then
    USER_OPTIONS=(--user root)
else
    IDS=(--build-arg "USER_ID=$(id -u)" --build-arg "GROUP_ID=$(id -g)")
fi
IMAGE="pilothouse-dev:$(id -u)"
provide "$IMAGE" Dockerfile.dev "${IDS[@]}"
# A shell needs a terminal; tests and CI have none.
TERMINAL=()
[ ! -t 0 ] || TERMINAL=(--interactive --tty)
exec "$ENGINE" run --rm "${TERMINAL[@]}" "${USER_OPTIONS[@]}" --volume "$ROOT:/checkout" "$IMAGE" "${ARGUMENTS[@]}"
