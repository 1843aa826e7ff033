#!/bin/sh
# Builds the image atrium with podman from the packages in packages/ (docs/packages.md). The base comes from Debian's archive, not from a
# registry of images; BASE=debian:12-slim takes one from a registry instead.
set -eu
cd "$(dirname "$0")/.."
deploy/install_packages.sh container
ls packages/atrium-common_*.deb >/dev/null 2>&1 || { echo "make_container: no packages in packages/; run make deb first" >&2; exit 1; }
base=${BASE:-}
if [ -z "$base" ]; then
    base=localhost/atrium-base
    if ! podman image exists "$base"; then
        echo "container: making the base from Debian's archive"
        archive=$(mktemp)
        trap 'rm -f "$archive"' EXIT
        mmdebstrap --quiet --variant=minbase --format=tar bookworm > "$archive"
        podman import --quiet "$archive" "$base" >/dev/null
    fi
fi
# chroot: no network and no control group of its own, which installing packages does without
podman build --quiet --isolation=chroot --build-arg "BASE=$base" --volume "$PWD/packages:/packages:ro" --tag localhost/atrium \
    --file deploy/Containerfile deploy
podman image inspect --format '{{.Size}}' localhost/atrium | awk '{ printf "container: localhost/atrium, %.0f MB\n", $1 / 1e6 }'
