#!/bin/bash
# Builds the fuzzers with clang and runs each for a while; see --help.
set -euo pipefail

usage() {
    cat <<'EOF'
usage: tests/fuzz/run.sh SECONDS [TARGET...]

Builds the fuzzers into build-fuzz (needs Debian's clang and libclang-rt-14-dev). Runs each TARGET, or all, for SECONDS one after the
other, with AddressSanitizer and UndefinedBehaviorSanitizer. Starts with tests/fuzz/seeds/TARGET and the inputs that earlier runs kept in
build-fuzz/corpus/TARGET. Writes findings to build-fuzz/findings/TARGET. To repeat a finding, give it as the only argument to
build-fuzz/bin/TARGET_fuzz. Copy it to tests/fuzz/seeds/TARGET to keep it as a test.

Prints a table with executions, executions per second and covered edges per target. Exit status: 0 no findings, 1 a finding,
2 wrong usage.

  --list    lists the targets (after the build)
  --help    this text
EOF
}

cd "$(dirname "$0")/../.."
readonly build=build-fuzz

build_fuzzers() {
    if [[ ! -f $build/build.ninja ]]; then
        CC=clang CXX=clang++ cmake -S . -B $build -G Ninja -DATRIUM_FUZZ=ON -DATRIUM_PCH=OFF >&2
    fi
    cmake --build $build --target fuzzers >&2
}

max_len() {
    case $1 in
        hull) echo 1024 ;;
        file_bundle | file_profiles | file_recording) echo 16384 ;;
        *) echo 4096 ;;
    esac
}

# run_one TARGET SECONDS: prints a row of the table; fails on a finding
run_one() {
    local target=$1 seconds=$2
    local corpus=$build/corpus/$target findings=$build/findings/$target log=$build/findings/$target.log
    mkdir -p "$corpus" "$findings"
    local folders=("$corpus")
    for folder in tests/fuzz/seeds/$target $build/samples/$target; do
        [[ -d $folder ]] && folders+=("$folder")
    done
    local result=clean
    LSAN_OPTIONS=suppressions=tests/lsan.supp:print_suppressions=0 \
        $build/bin/"${target}"_fuzz -max_total_time="$seconds" -timeout=20 -max_len="$(max_len "$target")" \
        -print_final_stats=1 -artifact_prefix="$findings"/ "${folders[@]}" >"$log" 2>&1 || result="FINDING, see $log"
    local executions per_second edges
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    per_second=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
    printf '| %-22s | %12s | %10s | %6s | %s |\n' "$target" "${executions:--}" "${per_second:--}" "${edges:--}" "$result"
    [[ $result == clean ]]
}

case ${1:-} in
    --help) usage; exit 0 ;;
    --list) build_fuzzers; cat $build/fuzzers.txt; exit 0 ;;
esac
if [[ ! ${1:-} =~ ^[1-9][0-9]*$ ]]; then
    usage >&2
    exit 2
fi
seconds=$1
shift

build_fuzzers
mapfile -t known <$build/fuzzers.txt
targets=("$@")
[[ $# -gt 0 ]] || targets=("${known[@]}")
for target in "${targets[@]}"; do
    if ! printf '%s\n' "${known[@]}" | grep -qxF -- "$target"; then
        printf 'no target %s; there are: %s\n' "$target" "${known[*]}" >&2
        exit 2
    fi
done

$build/bin/wire_samples $build/samples
printf '| %-22s | %12s | %10s | %6s | %s |\n' target executions 'per second' edges result
echo '|---|---:|---:|---:|---|'
status=0
for target in "${targets[@]}"; do
    run_one "$target" "$seconds" || status=1
done
exit $status
