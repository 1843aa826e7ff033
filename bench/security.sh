#!/bin/sh
# Measures what keys cost, what floods do to a closed world, and two homes behind NAT: `bench/security.sh [BUILD]`. See the scripts in
# bench/security. It takes a quarter of an hour.
set -eu
folder=$(dirname "$0")/security
"$folder/cost.sh" "${1:-build}"
"$folder/floods.sh" "${1:-build}"
"$folder/nat.sh" "${1:-build}"
