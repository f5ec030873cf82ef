#!/bin/sh
# The CAD kernel links libGL and libX11 even without a display. If they are missing, install them where we may
# (root on a Debian-like system), else print the exact command and stop.
# usage: system_libraries.sh PYTHON
set -u
python=$1
missing() { "$python" -c 'import ctypes
for name in ("libGL.so.1", "libX11.so.6"):
    ctypes.CDLL(name)' 2>/dev/null; [ $? -ne 0 ]; }

# macOS and Windows wheels of the kernel bring or find these themselves.
[ "$(uname -s)" = Linux ] || exit 0
missing || exit 0

packages="libgl1 libx11-6"
if command -v apt-get >/dev/null 2>&1; then
    if [ "$(id -u)" -eq 0 ]; then
        echo "installing $packages, which the CAD kernel needs" >&2
        apt-get update -qq >/dev/null && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $packages >/dev/null
        missing || exit 0
    fi
    command="sudo apt-get install $packages"
elif command -v dnf >/dev/null 2>&1; then
    command="sudo dnf install mesa-libGL libX11"
elif command -v pacman >/dev/null 2>&1; then
    command="sudo pacman -S libglvnd libx11"
else
    command="install the packages that hold libGL.so.1 and libX11.so.6"
fi
echo "error: libGL.so.1 or libX11.so.6 is missing, which the CAD kernel needs; run: $command" >&2
exit 1
