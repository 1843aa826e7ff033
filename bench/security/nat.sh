#!/bin/sh
# Measures two rooms and a viewer in three homes behind routers, through the tunnel of a hub: `bench/security/nat.sh [BUILD] [SECONDS]`. It
# is nat_test with a longer count. Keeps the figures in bench/results/, and renews the table of docs/measurements/security.md. Needs no
# rights.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-300}
cmake --build "$build" --target nat_test machine_score > /dev/null
nat=$(result security-nat.csv)
log=$(mktemp)
trap 'rm "$log"' EXIT
ATRIUM_NAT_SECONDS=$seconds "$build"/bin/nat_test > "$log" 2>&1 || { cat "$log"; exit 1; }
# value SITE WORD COUNT: the number after a word in the line of a site, of the first or second count
value() { grep "^site $1 " "$log" | sed -n "$3p" | sed "s/.* $2 \\([0-9.]*\\).*/\\1/"; }
{
    heading
    echo "until_picture_s,seconds,alice_received,alice_missing,alice_gap_ms,alice_median_ms,bob_received,bob_missing,bob_gap_ms,bob_median_ms,moved_gap_ms"
    printf '%s,%s' "$(sed -n 's/^until both .*: \([0-9.]*\) s/\1/p' "$log")" "$seconds"
    for site in alice bob; do
        for word in received missing longest_gap_ms median_ms; do printf ',%s' "$(value $site $word 1)"; done
    done
    printf ',%s\n' "$(value alice longest_gap_ms 2)"
} > "$nat"
python3 bench/security/tables.py nat "$nat" docs/measurements/security.md
