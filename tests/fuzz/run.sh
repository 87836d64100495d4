#!/bin/sh
# Fuzzes by hand, with libFuzzer and the address and undefined-behaviour sanitizers of clang:
#
#     tests/fuzz/run.sh TARGET MINUTES [ARG…]     e.g. tests/fuzz/run.sh outline 60 -jobs=2
#
# TARGET is the NAME of a fuzz_NAME.c, or all (so many minutes each, ARG: of libFuzzer). What is found lies in out/fuzz/found-TARGET and is run again by
# out/fuzz/build/tests/fuzz_TARGET FILE; once mended, it goes into the corpus by a telling name, and from then on every test run tries it. What libFuzzer
# thinks of on its way stays in out/fuzz/grown-TARGET.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${1:?TARGET}
minutes=${2:?MINUTES}
shift 2
out=${FUZZ_OUT:-$root/out/fuzz}
flags="-g -O1 -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined"
mkdir -p "$out"
[ -f "$out/build/build.ninja" ] ||
    CC=clang meson setup "$out/build" "$root" --buildtype=plain -Ddefault_library=static -Db_lundef=false -Dc_args="-DFUZZ $flags" >&2

dictionary() {
    case $1 in
    outline | drawing) echo svg ;;
    network) echo graphml ;;
    image) echo image ;;
    *) echo params ;;
    esac
}

# Examples that lie elsewhere.
examples() {
    case $1 in
    params) echo "$root/params" ;;
    outline) echo "$root/params/outlines" ;;
    esac
}

fuzz() {
    name=$1
    shift
    ninja -C "$out/build" -j2 "tests/fuzz_$name" >&2
    mkdir -p "$out/found-$name" "$out/grown-$name"
    "$out/build/tests/fuzz_$name" -max_total_time=$((minutes * 60)) -timeout=120 -rss_limit_mb=2048 -malloc_limit_mb=512 -max_len=40000 -print_final_stats=1 \
        -dict="$root/tests/fuzz/dict/$(dictionary "$name").dict" -artifact_prefix="$out/found-$name/" "$@" \
        "$out/grown-$name" "$root/tests/fuzz/corpus/$name" $(examples "$name")
}

if [ "$target" = all ]; then
    for file in "$root"/tests/fuzz/fuzz_*.c; do
        name=$(basename "$file" .c)
        fuzz "${name#fuzz_}" "$@" || echo "run.sh: ${name#fuzz_} failed" >&2
    done
else
    fuzz "$target" "$@"
fi
