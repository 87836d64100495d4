#!/bin/sh
# Equal leaves from every build: gcc and clang, unoptimised and optimised, against one snapshot. For continuous integration.
# usage: builds.sh [SNAPSHOT_FILE]
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
snapshot=${1:-$root/tests/snapshot/snapshot.txt}
tmp=$(mktemp -d "${TMPDIR:-/tmp}/venation-builds-XXXXXX")
trap 'rm -rf "$tmp"' EXIT
trap 'exit 129' HUP INT TERM
status=0
for cc in gcc clang; do
    for level in 0 3; do
        dir=$tmp/$cc-O$level
        echo "# $cc -O$level"
        CC=$cc meson setup "$dir" "$root" --buildtype=plain -Doptimization=$level -Ddebug=false >"$tmp/log" || { cat "$tmp/log" >&2; exit 1; }
        ninja -C "$dir" -j2 src/venation >"$tmp/log" || { cat "$tmp/log" >&2; exit 1; }
        "$root/tests/snapshot/snapshot.py" "$dir/src/venation" "$root/params" "$snapshot" || status=1
        rm -rf "$dir"
    done
done
exit $status
