#!/bin/sh
# Installs the packages that Atrium needs to build and run, from the archive of Debian 12. Does nothing if all are installed.
# `install_packages.sh deb` also installs what makes and checks Debian packages (docs/packages.md), and `container` what makes the image.
set -eu

packages="build-essential cmake ninja-build pkg-config ccache git python3 python3-opencv clang-format
cyclonedds-dev cyclonedds-tools libeigen3-dev libopencv-dev libdraco-dev libturbojpeg0-dev libjpeg62-turbo-dev libavformat-dev libbullet-dev
libglfw3-dev libegl-dev libosmesa6-dev python3-glad libimgui-dev fonts-dejavu-core libcli11-dev libtoml11-dev libspdlog-dev libassimp-dev
libceres-dev libfmt-dev nlohmann-json3-dev libzstd-dev liblz4-dev zlib1g-dev libexpected-dev libaravis-dev libpugixml-dev libssl-dev libgtest-dev libgmock-dev libcgal-dev libbenchmark-dev libx11-dev
wireguard-tools wireguard-go xvfb xauth valgrind faketime iproute2 nftables openssl procps"
for extra in "$@"; do
    case $extra in
        deb) packages="$packages debhelper dpkg-dev fakeroot lintian" ;;
        container) packages="$packages mmdebstrap podman crun netavark" ;;
        *) echo "packages: unknown argument '$extra'; valid: deb, container" >&2; exit 2 ;;
    esac
done

missing=""
for package in $packages; do
    state=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
    [ "$state" = "install ok installed" ] || missing="$missing $package"
done
if [ -z "$missing" ]; then
    echo "packages: all installed"
    exit 0
fi

as_root=""
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "packages: missing, and installing them needs root or sudo:$missing" >&2
        exit 1
    fi
    as_root="sudo"
fi
echo "packages: installing$missing"
$as_root apt-get update -qq
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
echo "packages: installed"
