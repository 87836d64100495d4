#!/bin/sh
# The same leaves on another kind of machine: builds for 64-bit ARM with a cross compiler, runs it in an emulator, compares with the snapshot.
# usage: aarch64.sh [SYSROOT]
# Installs what it needs from Debian (as root); SYSROOT, where libraries for ARM are kept, is made when it isn't there (default: a temporary one).
# Takes some minutes; run by hand.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
need="gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user mmdebstrap meson ninja-build python3"
# shellcheck disable=SC2086
dpkg-query -W $need >/dev/null 2>&1 || DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $need
tmp=$(mktemp -d "${TMPDIR:-/tmp}/venation-aarch64-XXXXXX")
trap 'rm -rf "$tmp"' EXIT
trap 'exit 129' HUP INT TERM
sys=${1:-$tmp/sysroot}
libraries=libc6-dev,libglib2.0-dev,libpng-dev,zlib1g-dev,libopenexr-dev,libjpeg62-turbo-dev,libtiff-dev,libjson-glib-dev,libgts-dev,libsuitesparse-dev,librsvg2-dev,libcairo2-dev
[ -d "$sys" ] || mmdebstrap --quiet --variant=extract --architecture=arm64 --include="$libraries" bookworm "$sys"
cat >"$tmp/cross" <<CROSS
[binaries]
c = ['aarch64-linux-gnu-gcc', '--sysroot=$sys']
ar = 'aarch64-linux-gnu-ar'
strip = 'aarch64-linux-gnu-strip'
pkgconfig = 'pkg-config'
exe_wrapper = ['qemu-aarch64', '-L', '$sys']
[properties]
sys_root = '$sys'
pkg_config_libdir = '$sys/usr/lib/aarch64-linux-gnu/pkgconfig:$sys/usr/share/pkgconfig'
[built-in options]
c_args = ['-I$sys/usr/include', '-I$sys/usr/include/aarch64-linux-gnu']
c_link_args = ['-L$sys/usr/lib/aarch64-linux-gnu', '-Wl,-rpath-link,$sys/usr/lib/aarch64-linux-gnu', '-Wl,-rpath-link,$sys/lib/aarch64-linux-gnu']
[host_machine]
system = 'linux'
cpu_family = 'aarch64'
cpu = 'aarch64'
endian = 'little'
CROSS
meson setup "$tmp/build" "$root" --cross-file "$tmp/cross" -Ddefault_library=static >"$tmp/log" || { cat "$tmp/log" >&2; exit 1; }
ninja -C "$tmp/build" src/venation >"$tmp/log" || { cat "$tmp/log" >&2; exit 1; }
printf '#!/bin/sh\nexec qemu-aarch64 -L "%s" "%s" "$@"\n' "$sys" "$tmp/build/src/venation" >"$tmp/venation"
chmod +x "$tmp/venation"
[ -z "${KEEP-}" ] || cp "$tmp/build/src/venation" "$KEEP"
"$root/tests/snapshot/snapshot.py" "$tmp/venation" "$root/params" "$root/tests/snapshot/snapshot.txt"
