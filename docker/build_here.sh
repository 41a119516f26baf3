#!/usr/bin/env bash
# Builds images on a machine without a container engine or access to an image registry: with
# buildah, on a base that debootstrap makes once. Used by `make test-image`; docs/how-to/deploy.md
# explains how to build them elsewhere.
#
#     docker/build_here.sh [IMAGE...]
#
#   pilothouse   docker/Dockerfile; the default
#   link         the same with LINK=1
#   ros2         docker/Dockerfile.ros2, on a base with the wheels of ROS 2 instead of a distribution
#   dev          docker/Dockerfile.dev
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

CACHE="${XDG_CACHE_HOME:-$HOME/.cache}/pilothouse"
SUITE=bookworm
BASE="localhost/pilothouse-base:$SUITE"
# Named by what it is made from, so that another list of wheels makes another base.
BASE_ROS2="localhost/pilothouse-base:ros2-$(sha256sum docker/Dockerfile.ros2-base | head -c 12)"

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
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT

# Which storage there is depends on the kernel and the file system: `vfs` works everywhere, and copies
# whole images. Also read by with_podman_here.sh and tests/support/container.py.
mkdir "$WORK"/{lower,upper,work,merged}
DRIVER=vfs
if unshare --mount mount -t overlay -o \
    "lowerdir=$WORK/lower,upperdir=$WORK/upper,workdir=$WORK/work" none "$WORK/merged" 2>/dev/null; then
    DRIVER=overlay
fi
cat > "$CACHE/storage.conf" <<END
[storage]
driver = "$DRIVER"
graphroot = "$CACHE/storage-$DRIVER"
runroot = "$CACHE/run-$DRIVER"
END
export CONTAINERS_STORAGE_CONF="$CACHE/storage.conf"

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
    container=$(buildah from scratch) &&
    buildah add "$container" "$WORK/root.tar" / &&
    buildah commit --format docker --rm "$container" "$BASE"
}

# Builds an image: its name, its Dockerfile, its base, and arguments of buildah.
build() {
    local more=(--build-arg "BASE=$3" "${@:4}")
    # For pip, if this machine has its own certificates.
    [ ! -d /etc/ssl/certs ] || more+=(--volume /etc/ssl/certs:/etc/ssl/certs:ro)
    buildah bud --isolation chroot --format docker "${more[@]}" --tag "$1" --file "docker/$2" .
}

has() { buildah inspect --type image "$1" >/dev/null 2>&1; }

has "$BASE" || quietly "Making the base of the images, once" make_base
for image in "${@:-pilothouse}"; do
    case "$image" in
        pilothouse)
            quietly "Building the image" build localhost/pilothouse Dockerfile "$BASE"
            ;;
        link)
            quietly "Building the image with the link" \
                build localhost/pilothouse-link Dockerfile "$BASE" --build-arg LINK=1
            ;;
        ros2)
            has "$BASE_ROS2" || quietly "Making the base of the image for ROS 2, once" \
                build "$BASE_ROS2" Dockerfile.ros2-base "$BASE"
            quietly "Building the image for ROS 2" \
                build localhost/pilothouse-ros2 Dockerfile.ros2 "$BASE_ROS2"
            ;;
        dev)
            # As run_dev.sh names it for root, for whom nothing is adapted.
            quietly "Building the development image" \
                build localhost/pilothouse-dev:0 Dockerfile.dev "$BASE"
            ;;
        *)
            echo "${0##*/}: no image is named '$image': pilothouse, link, ros2, dev" >&2
            exit 2
            ;;
    esac
done
# Removes the previous images of these names.
buildah rmi --prune >/dev/null
