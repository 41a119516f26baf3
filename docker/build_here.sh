#!/usr/bin/env bash
# Builds the image on a machine without a container engine or access to an image registry: with
# buildah, on a base that debootstrap makes once. Used by `make test-image`; docs/how-to/deploy.md
# explains how to build it elsewhere.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

CACHE="${XDG_CACHE_HOME:-$HOME/.cache}/pilothouse"
SUITE=bookworm
BASE="localhost/pilothouse-base:$SUITE"
IMAGE=localhost/pilothouse

if [ "$(id -u)" -ne 0 ]; then
    echo "Image not built: buildah needs root here."
    exit 0
fi

if ! { command -v buildah && command -v debootstrap; } >/dev/null; then
    if ! command -v apt-get >/dev/null; then
        echo "Image not built: buildah and debootstrap are not installed."
        exit 0
    fi
    echo "Installing buildah and debootstrap ..."
    export DEBIAN_FRONTEND=noninteractive
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends buildah debootstrap; } \
        </dev/null >/dev/null 2>&1 || { echo "Installation failed." >&2; exit 1; }
fi

mkdir -p "$CACHE"
exec 9>"$CACHE/lock"
flock 9
images() { buildah --storage-driver vfs --root "$CACHE/images" --runroot "$CACHE/run" "$@"; }
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT

# Prints what a step does, and its output if it fails.
quietly() {
    echo "$1 ..."
    shift
    "$@" </dev/null >"$WORK/log" 2>&1 || { cat "$WORK/log" >&2; exit 1; }
}

make_base() {
    local container
    debootstrap --variant=minbase --include=ca-certificates,python3,python3-venv \
        "$SUITE" "$WORK/root" &&
    tar -C "$WORK/root" --exclude='./var/cache/apt/*' --exclude='./var/lib/apt/lists/*' \
        -cf "$WORK/root.tar" . &&
    container=$(images from scratch) &&
    images add "$container" "$WORK/root.tar" / &&
    images commit --format docker --rm "$container" "$BASE"
}

build() {
    local more=()
    # For pip, if this machine has its own certificates.
    [ ! -d /etc/ssl/certs ] || more+=(--volume /etc/ssl/certs:/etc/ssl/certs:ro)
    images bud --isolation chroot --format docker --build-arg "BASE=$BASE" "${more[@]}" \
        --tag "$IMAGE" --file docker/Dockerfile .
}

if ! images inspect --type image "$BASE" >/dev/null 2>&1; then
    quietly "Making the base of the image, once" make_base
fi
quietly "Building the image" build
# Removes the previous image of this name.
images rmi --prune >/dev/null
