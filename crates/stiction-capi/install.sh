#!/bin/sh
# Installs the C and C++ interface under a prefix: headers, shared and static library, a CMake package
# and a pkg-config file.
#
#   crates/stiction-capi/install.sh PREFIX
#
# BUILT names a folder with libraries that are built already; without it they are built here, by the
# profile that PROFILE names (release without it). DESTDIR is put before the prefix, for packagers.
set -eu

if [ $# -ne 1 ]; then
    echo "usage: $0 PREFIX, a folder such as /usr/local" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
prefix=${DESTDIR:-}$1
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' "$root/Cargo.toml" | head -n 1)
major=${version%%.*}
series=${version%.*}

profile=${PROFILE:-release}
built=${BUILT:-${CARGO_TARGET_DIR:-$root/target}/$profile}
if [ -z "${BUILT:-}" ]; then
    (cd "$root" && cargo build --quiet --profile "$profile" -p stiction-capi)
fi

case $(uname -s) in
Darwin)
    made=libstiction_capi.dylib shared=libstiction.$version.dylib
    soname=@rpath/libstiction.$major.dylib names="libstiction.$major.dylib libstiction.dylib"
    ;;
*)
    made=libstiction_capi.so shared=libstiction.so.$version
    soname=libstiction.so.$major names="libstiction.so.$major libstiction.so"
    ;;
esac

mkdir -p "$prefix/include" "$prefix/lib/cmake/stiction" "$prefix/lib/pkgconfig"
cp "$here/include/stiction.h" "$here/include/stiction.hpp" "$prefix/include/"
cp "$built/libstiction_capi.a" "$prefix/lib/libstiction.a"
cp "$built/$made" "$prefix/lib/$shared"
for name in $names; do
    ln -sf "$shared" "$prefix/lib/$name"
done

fill() {
    sed -e "s|@VERSION@|$version|g" -e "s|@SERIES@|$series|g" -e "s|@SHARED@|$shared|g" \
        -e "s|@SONAME@|$soname|g" "$here/package/$1.in" >"$2/$1"
}
fill stiction.pc "$prefix/lib/pkgconfig"
fill stiction-config.cmake "$prefix/lib/cmake/stiction"
fill stiction-config-version.cmake "$prefix/lib/cmake/stiction"
