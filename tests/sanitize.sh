#!/bin/sh
# The tests once more under sanitizers: of addresses and undefined behaviour, then of threads. Emits TAP.
# Usage: sanitize.sh SOURCE FOLDER [few|all]; builds in FOLDER/sanitize-*. few, for every day: what reads other people's files, the command, and threads.
# Without all the slowest tests are left out.
# GLib itself is not built for the thread sanitizer, which so knows nothing of its locks: blocks that its slices hand from thread to thread look like
# races, hence G_SLICE. What the pool of threads does is plain atomics, and is seen.
set -u
source=$1 folder=$2 few='' all=''
[ "${3-}" != few ] || few=yes
[ "${3-}" != all ] || all=yes
number=0 bad=0
export G_SLICE=always-malloc UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 ASAN_OPTIONS=detect_stack_use_after_return=1 TSAN_OPTIONS=halt_on_error=1
unset LD_PRELOAD
mkdir -p "$folder"
# What fontconfig keeps of its own until the program ends.
supp=$folder/sanitize.supp
echo 'leak:libfontconfig' >"$supp"
export LSAN_OPTIONS="suppressions=$supp:print_suppressions=0"
if ! echo 'int main(void) { return 0; }' | cc -xc - -fsanitize=address,undefined -o /dev/null || ! echo 'int main(void) { return 0; }' | cc -xc - -fsanitize=thread -o /dev/null; then
    if [ "${VENATION_REQUIRE-}" = all ]; then
        echo "1..1"
        echo "not ok 1 - the compiler has no sanitizers"
        exit 1
    fi
    echo "1..0 # SKIP the compiler has no sanitizers"
    exit 0
fi
log=$folder/sanitize.log

check() { # NAME COMMAND…
    number=$((number + 1))
    name=$1
    shift
    if "$@" >"$log" 2>&1; then echo "ok $number - $name"; else bad=1; echo "not ok $number - $name"; tail -n 60 "$log" | sed 's/^/# /'; fi
}
build() { # KIND TARGET…
    kind=$1
    shift
    b=$folder/sanitize-$kind
    [ -f "$b/build.ninja" ] || meson setup "$b" "$source" -Db_sanitize="$(echo "$kind" | tr - ,)" -Db_lundef=false -Doptimization=1 -Ddebug=true || return 1
    ninja -C "$b" -j2 "$@"
}
# The unit tests but those named, one after the other so that each has a line of its own below
names() { meson test -C "$b" --list --suite "$1" 2>/dev/null | sed -n 's#^venation:[^ ]* / ##p'; }
run_tests() { # NAME…
    meson test -C "$b" --no-rebuild --num-processes 2 --timeout-multiplier 5 --print-errorlogs "$@"
}
command_runs() { # threads under what people call
    v=$b/src/venation
    set -- --size 256 --threads 4 --quiet --set growth.final_length=120 --set growth.initial_length=40 -o "$folder/sanitize-out"
    "$v" grow "$source/params/poplar.ini" "$@" && "$v" grow "$source/params/ginkgo.ini" --every 10 --frames maps --maps height "$@" &&
        "$v" shape "$source/params/poplar.ini" --rig 4 --lod 2 "$@" && "$v" shape "$source/params/sweetgum.ini" --pose withered "$@"
    status=$?
    rm -rf "$folder/sanitize-out"
    return $status
}

targets=
[ -z "$few" ] || targets="src/venation $(cd "$source/tests/fuzz" && for f in fuzz_*.c; do echo "tests/${f%.c}"; done)"
check "it builds with -fsanitize=address,undefined" build address-undefined $targets
left_out=found # five minutes by itself
[ "$all" ] && left_out=none
[ "$few" ] || check "unit tests, addresses and undefined behaviour" run_tests --suite unit $(names unit | grep -vx $left_out)
check "fuzz tests, addresses and undefined behaviour" run_tests $(names fuzz)
check "the command, addresses and undefined behaviour" run_tests --suite cli cli
[ "$few" ] || check "sweeps, addresses and undefined behaviour" run_tests --suite cli sweep

threads="parallel neighbours image api"
[ "$few" ] && threads="parallel image"
[ "$all" ] && threads="$threads paint simulation"
check "it builds with -fsanitize=thread" build thread src/venation $(for t in $threads; do echo "tests/test_$t"; done)
for t in $threads; do check "threads: $t" "$b/tests/test_$t"; done
check "threads: grow and shape by four" command_runs
echo "1..$number"
exit $bad
