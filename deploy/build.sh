#!/bin/sh
# Installs packages, configures and builds: `deploy/build.sh FOLDER [cmake options]`. Skips finished steps.
# TARGETS="a b" builds only these targets.
set -eu
cd "$(dirname "$0")/.."
folder=$1
shift
deploy/install_packages.sh
echo "configure: $folder"
cmake -S . -B "$folder" -G Ninja "$@" > "$folder.configure.log" 2>&1 || { cat "$folder.configure.log" >&2; exit 1; }
mv "$folder.configure.log" "$folder/configure.log"
echo "build: $folder (the first time takes some minutes)"
cmake --build "$folder" --target ${TARGETS:-all}
