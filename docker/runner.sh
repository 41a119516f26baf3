# shellcheck shell=bash
# What the runners run_*.sh have in common; they source it. Its variables are theirs:
# shellcheck disable=SC2034

ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# Least privilege, as in docs/how-to/deploy.md.
CONFINED=(--read-only --tmpfs /tmp --cap-drop ALL --security-opt no-new-privileges)

# Shows the comment at the top of the runner.
usage() { sed -n '2,/^[^#]/s/^#\( \|$\)//p' "$0"; }

die() {
    echo "${0##*/}: $*" >&2
    exit 2
}

# Reads the options of a runner into HERE, BUILD, BASE and PORT, and leaves the rest in ARGUMENTS.
# First argument: the options that the runner has.
HERE='' BUILD='' BASE='' PORT=8000 ARGUMENTS=()
parse() {
    local known=" --help $1 "
    shift
    while [[ "${1:-}" == -* ]]; do
        [[ "$known" == *" $1 "* ]] || die "unknown option '$1'; --help lists what there is"
        case "$1" in
            --help) usage; exit ;;
            --here) HERE=1 ;;
            --build) BUILD=1 ;;
            *)
                [ $# -gt 1 ] || die "$1 needs a value"
                if [ "$1" = --base ]; then BASE="$2"; else PORT="$2"; fi
                shift
                ;;
        esac
        shift
    done
    ARGUMENTS=("$@")
}

# Sets ENGINE to `docker` or `podman`, whichever works on this machine.
find_engine() {
    for ENGINE in docker podman; do
        ! "$ENGINE" ps >/dev/null 2>&1 || return 0
    done
    die "neither docker nor podman works on this machine; --here runs without a container"
}

# Builds an image if it is missing, or if BUILD is set. Arguments: its name, its Dockerfile, more
# arguments of `build`. BASE: the base image, unless it is that of the Dockerfile.
provide() {
    local options=(--tag "$1" --file "$ROOT/docker/$2" "${@:3}")
    if [ -z "$BUILD" ] && "$ENGINE" image inspect "$1" >/dev/null 2>&1; then return; fi
    [ -z "$BASE" ] || options+=(--build-arg "BASE=$BASE")
    # The other format of podman has no health check.
    [ "$ENGINE" != podman ] || options+=(--format docker)
    "$ENGINE" build "${options[@]}" "$ROOT"
}

# Sets USER_OPTIONS so that a container has the user of this shell; root keeps that of the image.
as_this_user() {
    USER_OPTIONS=()
    if [ "$(id -u)" -ne 0 ]; then
        USER_OPTIONS=(--user "$(id -u):$(id -g)")
        # Otherwise podman without root maps the user to another one of the machine.
        [ "$ENGINE" != podman ] || USER_OPTIONS+=(--userns keep-id)
    fi
}

# Sets PILOTHOUSE to the `pilothouse` of this shell, or of an environment of the checkout.
find_pilothouse() {
    PILOTHOUSE="$(command -v pilothouse || true)"
    [ -n "$PILOTHOUSE" ] || PILOTHOUSE="$ROOT/$1/bin/pilothouse"
    [ -x "$PILOTHOUSE" ] || die "pilothouse is not installed; run: make $1/installed"
}
