#!/bin/sh
# Predicts sites of 16 and 64 cameras of 2 MP at 60/s on hosts of 4 cores by `atrium plan`, and renews the table of
# docs/measurements/site_hosts.md: `bench/site/site_scale.sh [BUILD]`. What it predicts by: deploy/costs.toml (site_costs.sh).
set -eu
. "$(dirname "$0")/../common.sh"
exec python3 bench/site/site_scale.py --build "$build" --out "$(result site-scale).json"
