#!/bin/sh
# Installs the build into a scratch folder and uses it as a stranger would: header, pkg-config file, library, man page, completion.
# Usage: test_install.sh BUILD SOURCE PREFIX; emits TAP.
set -eu
build=$1 source=$2
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
DESTDIR=$root meson install -C "$build" --no-rebuild --quiet
prefix=$root$3
number=0
check() { # NAME COMMAND…
    number=$((number + 1))
    name=$1
    shift
    if "$@" >"$root/log" 2>&1; then echo "ok $number - $name"; else echo "not ok $number - $name"; sed 's/^/# /' "$root/log"; fi
}
pc=$(dirname "$(find "$prefix" -name venation.pc)")
export PKG_CONFIG_PATH=$pc PKG_CONFIG_SYSROOT_DIR=$root LD_LIBRARY_PATH=$(dirname "$pc")
example() {
    # glib lives outside the scratch folder: take its flags without the prefix that the scratch folder puts before them
    flags=$(pkg-config --cflags --libs venation | sed "s#$root/usr/include#/usr/include#g; s#$root/usr/lib#/usr/lib#g")
    gcc -Wall -Werror -o "$root/example" "$source/tests/cli/example.c" $flags
    cat >"$root/small.ini" <<INI
[growth]
initial_length = 50
final_length = 120
INI
    "$root/example" "$root/small.ini" | grep -q '^[1-9][0-9]* nodes, [1-9][0-9]* edges, widest vein [0-9.]* segments$'
}
echo 1..6
check "a program builds and runs against the installed library" example
check "the public header compiles alone" sh -c "
    flags=\$(pkg-config --cflags glib-2.0 | sed 's#$root/usr#/usr#g')
    echo '#include <venation.h>' >$root/h.c
    gcc -std=c11 -Wall -Wextra -Werror -I$prefix/include \$flags -fsyntax-only $root/h.c"
check "only ven_ names are exported" sh -c "
    ! nm -D --defined-only $(find "$prefix" -name 'libvenation.so') | awk '{print \$3}' | grep -v '^ven_'"
check "the man page renders" sh -c "man -l $prefix/share/man/man1/venation.1 | grep -q kill_distance"
check "the completion is shell" bash -n "$prefix/share/bash-completion/completions/venation"
check "parameter files are installed" test -s "$prefix/share/venation/params/poplar.ini"
