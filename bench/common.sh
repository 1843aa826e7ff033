# Sourced by the scripts of the rooms. Answers --help with the comment at their top, goes to the root of the tree, and sets `build` and
# `machine`.
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/../.."
build=${1:-build}
machine=$(lscpu | sed -n 's/^Model name: *//p')

# result NAME: prints the path of today's result on this machine
result() {
    mkdir -p bench/results
    echo "bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-$1"
}

# heading: prints date, commit, machine and score, for the first line of a result
heading() { echo "# $(date -u +%Y-%m-%dT%H:%MZ), commit $(git rev-parse --short=7 HEAD), $machine, $(bench/score.sh "$build")"; }
