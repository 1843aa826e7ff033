#!/bin/sh
# Measures what the work of a site costs on one core of this machine, and renews deploy/costs.toml, by which `atrium plan` predicts:
# `bench/site/site_costs.sh [BUILD]`. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be idle. The first run renders the pictures.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target site_costs > /dev/null
costs=$("$build"/bin/site_costs)
score=$("$build"/bin/machine_score --json | sed -n 's/.*"one_core": {"score": \([0-9.]*\).*/\1/p')
cat > deploy/costs.toml << END
# What the work of a site costs on one core. Written by bench/site/site_costs.sh; \`atrium plan\` reads it.
[machine]
name = "$machine"
score = $score
measured = "$(date -u +%Y-%m-%dT%H:%MZ), commit $(git rev-parse --short=7 HEAD)"

$costs
END
cat deploy/costs.toml
