#!/bin/sh
# What the tests run through: lines and branches of src, by file, those with the most lines missed first.
# Usage: coverage.sh FOLDER [TEST…]     builds in FOLDER, runs the tests named (default: unit tests, fuzz replays, the command), and leaves pages
# in FOLDER/pages for a look at what is missed: FOLDER/pages/index.html. Needs lcov, from Debian.
# What ends by force counts nothing: runs under failing memory and disks (faults), and the points of test_extremes. Its own files make the command's test
# of files that may not grow fail.
set -eu
source=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:?FOLDER}
shift
[ -f "$folder/build.ninja" ] || meson setup "$folder" "$source" -Db_coverage=true -Doptimization=1 -Ddebug=false -Ddefault_library=static -Db_ndebug=true >&2
ninja -C "$folder" -j2 >&2
find "$folder" -name '*.gcda' -delete
[ $# -gt 0 ] || set -- --suite unit --suite fuzz --suite cli
meson test -C "$folder" --no-rebuild --num-processes 2 --timeout-multiplier 5 "$@" >&2 || echo "coverage.sh: a test failed" >&2
lcov --quiet --capture --directory "$folder" --rc lcov_branch_coverage=1 --output-file "$folder/all.info" >&2
lcov --quiet --extract "$folder/all.info" "$source/src/*" --rc lcov_branch_coverage=1 --output-file "$folder/src.info" >&2
genhtml --quiet --branch-coverage --output-directory "$folder/pages" "$folder/src.info" >&2
lcov --summary "$folder/src.info" --rc lcov_branch_coverage=1 2>&1 | grep -E 'lines|functions|branches'
awk -F: -v cut="$source/" '
    /^SF:/ { file = substr($0, 4); sub(cut, "", file) }
    /^LF:/ { lines = $2 }
    /^LH:/ { hit = $2 }
    /^BRF:/ { branches = $2 }
    /^BRH:/ { taken = $2 }
    /^end_of_record/ { printf "%5d of %5d lines, %5d of %5d branches missed: %s\n", lines - hit, lines, branches - taken, branches, file
                       branches = taken = 0 }' "$folder/src.info" | sort -rn
