#!/usr/bin/env bash
# Measures what tools/batch/README.md says of cost: what one asset takes, what a batch adds, and what a plan of many takes.
# Usage: tools/batch/measure.sh SINEW [FOLDER of assets (assets/character)] [number of a large plan (100000)]
set -euo pipefail
sinew=$(realpath "$1")
folder=$(realpath "${2:-$(dirname "$0")/../../assets/character}")
many=${3:-100000}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
TIMEFORMAT='%U %S %R'

value() {  # value NAME JSON-FILE
  sed -n "s/.*\"$1\":\([0-9.e-]*\).*/\1/p" "$2"
}

processor() {  # processor COMMAND…: seconds of processor time and of the clock
  { time "$@" >/dev/null 2>&1 || true; } 2>&1 | awk '{printf "%.2f s (%.2f s by the clock)", $1 + $2, $3}'
}

echo "{\"jobs\": [{\"convert\": \"$folder\"}]}" >"$work/manifest.json"
for jobs in 1 2 4; do
  [ $jobs -le "$(nproc)" ] || continue
  "$sinew" batch plan -q "$work/manifest.json" -o "$work/run$jobs"
  begin=$(date +%s%N)
  "$sinew" batch run "$work/run$jobs" -j $jobs --json -q >"$work/counts" 2>/dev/null || true
  wall=$((($(date +%s%N) - begin) / 1000000))
  units=$(("$(value done "$work/counts")" + "$(value failed "$work/counts")"))
  awk -v u=$units -v own="$(value own_processor_seconds "$work/counts")" -v all="$(value work_processor_seconds "$work/counts")" \
    -v j=$jobs -v wall=$wall 'BEGIN {printf "-j %d: %d assets, %.2f s of processor time each; the batch itself adds %.1f %%; %.1f s by the clock\n", j, u, all / u, 100 * own / all, wall / 1000}'
done
echo "again, all there: $(processor "$sinew" batch run "$work/run1" -q)"
echo "merge: $(processor "$sinew" batch merge "$work/run1" -q)"

mkdir "$work/many"
seq "$many" | awk -v folder="$work/many" '{
  file = folder "/" $1 ".bvh"
  printf "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 0\nEnd Site\n{\nOFFSET 0 %d 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n\n", $1 > file
  close(file)
}'
echo "{\"jobs\": [{\"convert\": \"many\"}]}" >"$work/many.json"
echo "plan of $many: $(processor "$sinew" batch plan "$work/many.json" -o "$work/large")"
echo "its size: $(du -sh --apparent-size "$work/large" | cut -f 1) in $(ls "$work/large/shards" | wc -l) shards"
echo "status of $many: $(processor "$sinew" batch status "$work/large")"
