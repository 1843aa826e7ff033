#!/bin/sh
# Measures what keys cost, and what floods do to a closed world: `bench/security.sh [BUILD]`. See bench/security/cost.sh and floods.sh.
set -eu
folder=$(dirname "$0")/security
"$folder/cost.sh" "${1:-build}"
"$folder/floods.sh" "${1:-build}"
