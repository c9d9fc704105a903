#!/bin/sh
# Builds the parts of three.js anew, in a temporary folder, and compares them with what is committed.
# With --replace the committed files are replaced instead.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
vendor="$here/../../viewer/web/vendor"
command -v npm >/dev/null || { echo "web bundle: needs npm; on Debian: apt-get install -y npm" >&2; exit 1; }

room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
cp "$here/package.json" "$here/package-lock.json" "$here/parts.js" "$room"
cd "$room"
npm ci --no-audit --no-fund --ignore-scripts --loglevel=error
npm run --silent build
cp node_modules/three/LICENSE LICENSE-three.txt

if [ "${1:-}" = --replace ]; then
    cp three.min.js LICENSE-three.txt "$vendor"
fi
for file in three.min.js LICENSE-three.txt; do
    cmp "$file" "$vendor/$file" || {
        echo "$file is not what npm builds: tools/web_bundle/rebuild.sh --replace puts that in" >&2
        exit 1
    }
done
echo "web bundle: the committed files are what npm builds"
