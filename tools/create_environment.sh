#!/bin/sh
# Creates the virtual environment .venv with every library of requirements.lock and bathyflash
# itself in editable form. PYTHON names the interpreter; without it the first of 3.11 or later is
# taken.
set -eu
cd "$(dirname "$0")/.."

is_new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null
}

find_python() {
    for candidate in ${PYTHON:-python3 python3.13 python3.12 python3.11 python}; do
        if command -v "$candidate" >/dev/null && is_new_enough "$candidate"; then
            echo "$candidate"
            return
        fi
    done
}

python=$(find_python)
if [ -z "$python" ]; then
    echo "bathyflash needs Python 3.11 or later; none is in PATH (${PYTHON:-python3})." >&2
    echo "Install one, or name it: make venv PYTHON=/path/to/python3.12" >&2
    exit 1
fi
has_venv() {
    "$python" -c 'import ensurepip, venv' 2>/dev/null
}

if ! has_venv && [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
    echo "installing python3-venv"
    apt-get update -qq && apt-get install -y -qq python3-venv >/dev/null || true
fi
if ! has_venv; then
    echo "$python lacks the module venv. On Debian or Ubuntu type:" >&2
    echo "  sudo apt-get install -y python3-venv" >&2
    exit 1
fi

echo "creating .venv with $("$python" --version); the first time takes some minutes"
"$python" -m venv .venv
pip=".venv/bin/python -m pip --disable-pip-version-check --no-input"
$pip install --quiet --require-hashes -r requirements.lock
$pip install --quiet --no-deps --no-build-isolation -e .
