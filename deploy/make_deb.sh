#!/bin/sh
# Builds the Debian packages of this tree into packages/ (docs/packages.md). ATRIUM_PACKAGE_VERSION sets another version.
set -eu
cd "$(dirname "$0")/.."
deploy/install_packages.sh deb

# One source of the version: project() in CMakeLists.txt. Before the tag of that version, packages carry the time of the commit, so a newer
# one replaces an older one, and the version itself replaces them all.
version=$(sed -n 's/^project(atrium VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ -n "$version" ] || { echo "make_deb: CMakeLists.txt has no project(atrium VERSION ...)" >&2; exit 1; }
seconds=$(git log -1 --format=%ct 2>/dev/null || date +%s)
if ! git describe --exact-match --match "v$version" >/dev/null 2>&1; then
    version="$version~$(date -u -d "@$seconds" +%Y%m%d.%H%M%S)"
fi
version=${ATRIUM_PACKAGE_VERSION:-$version}
maintainer=$(sed -n 's/^Maintainer: //p' debian/control)
cat > debian/changelog <<EOF
atrium ($version) unstable; urgency=medium

  * See /usr/share/doc/atrium-common/CHANGELOG.md.

 -- $maintainer  $(LC_ALL=C date -u -R -d "@$seconds")
EOF

mkdir -p packages/symbols
rm -f packages/*.deb packages/symbols/*.deb debian/debhelper-build-stamp debian/files
# -nc: the build folder build-deb is used again
log=packages/build.log
echo "packages: building atrium $version (the first time takes some minutes; $log)"
ATRIUM_PACKAGES=packages DEB_BUILD_OPTIONS="${DEB_BUILD_OPTIONS:-parallel=$(nproc)}" \
    dpkg-buildpackage --build=binary --no-sign --no-pre-clean --buildinfo-file="packages/atrium_$version.buildinfo" \
    --changes-file="packages/atrium_$version.changes" --buildinfo-option=-upackages --changes-option=-upackages > "$log" 2>&1 ||
    { tail -n 40 "$log" >&2; echo "make_deb: failed; $log has all of it" >&2; exit 1; }
mv packages/*-dbgsym_*.deb packages/symbols/
rm -f packages/*.buildinfo packages/*.changes # they are for archives, and name the files where they were
ls packages/*.deb
