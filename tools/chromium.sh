#!/bin/sh
# Finds the browser that the web page is tested in; installs Debian's on Debian or Ubuntu as root,
# otherwise says loudly that these tests will not run.
set -eu

command -v chromium >/dev/null || command -v chromium-browser >/dev/null && exit 0

if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
    echo "installing chromium, for the tests of the web page"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium >/dev/null || true
    command -v chromium >/dev/null && exit 0
fi

echo "======================================================================" >&2
echo "NO CHROMIUM: the web page is NOT tested in a browser. On Debian type:" >&2
echo "  sudo apt-get update && sudo apt-get install -y chromium" >&2
echo "======================================================================" >&2
