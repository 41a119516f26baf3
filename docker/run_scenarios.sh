#!/usr/bin/env bash
# Runs scenarios of examples/scenarios in virtual time. Exit code 1: one was not as expected.
#
#     docker/run_scenarios.sh [--here] [--build] [--base IMAGE] [SET...]
#
#   state_manager  the error of each signal, and two errors at once
#   drive          tasks that are paused, resumed, replaced and cancelled
#   modes          the four steps of D4.8, Annex 4, and a node that returns
#
# Without a SET, all of them.
#
#   --here        without a container, with the `pilothouse` of this shell or of .venv
#   --build       build the image anew; without it, only if it is missing
#   --base IMAGE  build on this image instead of that of docker/Dockerfile
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=runner.sh
. "$(dirname "${BASH_SOURCE[0]}")/runner.sh"

declare -A SETS=(
    [state_manager]="battery estop gps_lost signal_lost signal_low stale_data temperature
        two_causes_at_once"
    [drive]="cancel_while_pausing emergency_stop_during_the_drive error_during_the_drive
        operator_hold_across_a_replaced_task stale_pose"
    [modes]="annex4_step1 annex4_step2 annex4_step3 annex4_step4 node_returns"
)

parse "--here --build --base" "$@"
CHOSEN=("${ARGUMENTS[@]}")
[ ${#CHOSEN[@]} -gt 0 ] || CHOSEN=(state_manager drive modes)
for chosen in "${CHOSEN[@]}"; do
    [ -n "${SETS[$chosen]:-}" ] || die "unknown set '$chosen'; see --help"
done

if [ -n "$HERE" ]; then
    find_pilothouse .venv
    SIMULATE=("$PILOTHOUSE" simulate)
    EXAMPLES="$ROOT/examples"
else
    find_engine
    provide pilothouse Dockerfile
    SIMULATE=("$ENGINE" run --rm --no-healthcheck "${CONFINED[@]}" --volume "$ROOT/examples:/examples:ro"
        pilothouse simulate)
    EXAMPLES=/examples
fi

code=0
for chosen in "${CHOSEN[@]}"; do
    for scenario in ${SETS[$chosen]}; do
        "${SIMULATE[@]}" "$EXAMPLES/scenarios/$scenario.yaml" || code=1
    done
done
exit "$code"
