#!/usr/bin/env bash
# Runs a command in which `podman` works and has the images of build_here.sh, on a machine whose
# control groups no engine accepts. It needs root; without it, the command has no podman.
#
#     docker/with_podman_here.sh COMMAND...
#
# What podman writes, mounts and adds to networks is gone after the command.
set -euo pipefail

CACHE="${XDG_CACHE_HOME:-$HOME/.cache}/pilothouse"
NEEDED=(podman crun netavark iptables iproute2)

if [ "$(id -u)" -ne 0 ] || ! command -v apt-get >/dev/null || [ ! -f "$CACHE/storage.conf" ]; then
    exec "$@"
fi
if ! { command -v podman && command -v crun && command -v iptables && command -v ip; } >/dev/null; then
    echo "Installing podman ..."
    export DEBIAN_FRONTEND=noninteractive
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends "${NEEDED[@]}"; } \
        </dev/null >/dev/null 2>&1 || { echo "Installation failed." >&2; exit 1; }
fi

DRIVER=$(sed -n 's/^driver = "\(.*\)"/\1/p' "$CACHE/storage.conf")
# Below the cache, since both may have to be in one file system.
WORK=$(mktemp -d "$CACHE/podman-XXXXXX")
trap 'rm -rf "$WORK"' EXIT
cat > "$WORK/storage.conf" <<END
[storage]
driver = "$DRIVER"
graphroot = "$WORK/storage"
runroot = "$WORK/run"
[storage.options]
additionalimagestores = ["$CACHE/storage-$DRIVER"]
END
# Limits of resources are for the engine of a robot; here the kernel may refuse them.
cat > "$WORK/containers.conf" <<END
[containers]
cgroups = "disabled"
default_ulimits = []
[engine]
cgroup_manager = "cgroupfs"
events_logger = "none"
[network]
network_backend = "netavark"
END
export CONTAINERS_STORAGE_CONF="$WORK/storage.conf" CONTAINERS_CONF="$WORK/containers.conf"
# crun rejects a machine that has both versions of control groups, even where it shall set none.
# shellcheck disable=SC2016
unshare --mount --net bash -c '
    mount -t tmpfs none /run && mount -t tmpfs none /sys/fs/cgroup && ip link set lo up && "$@"' - "$@"
