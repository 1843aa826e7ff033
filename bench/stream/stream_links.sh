#!/usr/bin/env bash
# Prints the rows of docs/measurements/links.md: bench/stream/stream_links.sh [build folder]. Takes about seven minutes. Needs /dev/net/tun,
# but no rights.
set -euo pipefail
. "$(dirname "$0")/../common.sh"
profiles=$(mktemp -d)
trap 'rm -r "$profiles"' EXIT

# histories WRITER READER: prints a file whose profiles of meshes and textures have these history depths
histories() {
    local file=$profiles/$1_$2.xml
    awk -v writer="$1" -v reader="$2" '
        /<qos_profile name="(stream|texture)">/ { inside = 1 }
        /<\/qos_profile>/ { inside = 0 }
        /<datawriter_qos>/ { depth = writer }
        /<datareader_qos>/ { depth = reader }
        inside { sub(/<depth>8</, "<depth>" depth "<")
                 sub(/<max_samples_per_instance>8</, "<max_samples_per_instance>" depth "<") }
        { print }' qos/profiles.xml > "$file"
    echo "$file"
}

# internal NACK_MS HEARTBEAT_MS [MORE]
internal() {
    echo "<NackDelay>$1ms</NackDelay><HeartbeatInterval min=\"$(($2 / 4))ms\" minsched=\"$(($2 / 2))ms\" max=\"1s\">$2ms</HeartbeatInterval>" \
         "<MaxQueuedRexmitBytes>1MB</MaxQueuedRexmitBytes>${3:-}"
}
defrag="<DefragReliableMaxSamples>256</DefragReliableMaxSamples>"

# row NAME INTERNAL PROFILES MBIT/S DELAY_MS JITTER_MS LOSS MESH TEXTURE [MESSAGE FRAGMENT [TEXTURE_WRITERS]]
row() { "$build"/bin/stream_links "$1" "$2" "$3" "$4" "$5" "$6" "$7" 300 "${@:8}" | tail -n "${lines:-1}"; }

lines=2 row "middle, 20 Mbit/s, no loss" "$(internal 5 20)" "$(histories 1 1)" 20 50 10 0 12000 4000
row "large, 20 Mbit/s, no loss" "$(internal 5 20)" "$(histories 1 1)" 20 50 10 0 20000 7000
row "large, 5 Mbit/s, no loss" "$(internal 5 20)" "$(histories 1 1)" 5 50 10 0 20000 7000
for loss in 0.01 0.05; do
    for h in "1 1" "8 1" "8 8"; do
        file=$(histories $h)
        row "middle, $loss, history $h" "$(internal 5 20)" "$file" 20 50 10 $loss 12000 4000
        row "small, 5 Mbit/s, $loss, history $h" "$(internal 5 20)" "$file" 5 50 10 $loss 4000 900
    done
    file=$(histories 8 8)
    row "middle, $loss, defrag" "$(internal 5 20 $defrag)" "$file" 20 50 10 $loss 12000 4000
    row "middle, $loss, writer per camera" "$(internal 5 20 $defrag)" "$file" 20 50 10 $loss 12000 4000 1400 1300 8
    row "middle, $loss, and NACK 30" "$(internal 30 30 $defrag)" "$file" 20 50 10 $loss 12000 4000 1400 1300 8
    row "middle, $loss, history 16" "$(internal 5 20 $defrag)" "$(histories 16 16)" 20 50 10 $loss 12000 4000 1400 1300 8
    row "middle, $loss, one datagram" "$(internal 120 20 $defrag)" "$file" 20 50 10 $loss 12000 4000 65500 63000
    row "large, 2 ms, $loss" "$(internal 2 5 $defrag)" "$(histories 1 1)" 0 2 0 $loss 20000 7000
done
for h in "1 1" "8 8"; do
    row "middle, 10 ms, 0.01, history $h" "$(internal 5 20)" "$(histories $h)" 20 10 2 0.01 12000 4000
done
