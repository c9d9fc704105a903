#!/bin/sh
# Finds the shared libraries that rendering and meshes need; installs the missing ones on Debian or
# Ubuntu as root, otherwise prints the one line to type.
set -eu

LIBRARIES="
libexpat.so.1     libexpat1
libEGL.so.1       libegl1
libGL.so.1        libgl1
libusb-1.0.so.0   libusb-1.0-0
libX11.so.6       libx11-6
libidn2.so.0      libidn2-0
libudev.so.1      libudev1
libgomp.so.1      libgomp1
"

[ "$(uname -s)" = Linux ] || exit 0
PATH="$PATH:/sbin:/usr/sbin"
command -v ldconfig >/dev/null || {
    echo "system libraries: no ldconfig here, so they are not checked; 'bathyflash doctor' tries them"
    exit 0
}

missing_packages() {
    present=$(ldconfig -p)
    echo "$LIBRARIES" | while read -r library package; do
        [ -z "$library" ] || case "$present" in
            *"$library "*) ;;
            *) printf '%s ' "$package" ;;
        esac
    done
}

missing=$(missing_packages)
[ -n "$missing" ] || exit 0

if ! command -v apt-get >/dev/null; then
    echo "Missing system libraries, by their Debian names: $missing" >&2
    echo "Install them with this system's package manager, then run make again." >&2
    exit 1
fi
if [ "$(id -u)" -ne 0 ]; then
    echo "Missing system libraries. Type this, then run make again:" >&2
    echo "  sudo apt-get update && sudo apt-get install -y --no-install-recommends $missing" >&2
    exit 1
fi

echo "installing system libraries: $missing"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
# shellcheck disable=SC2086  # one argument a package
apt-get install -y -qq --no-install-recommends $missing >/dev/null
missing=$(missing_packages)
[ -z "$missing" ] || { echo "still missing after installation: $missing" >&2; exit 1; }
