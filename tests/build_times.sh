#!/usr/bin/env bash
# What a build from nothing costs in processor time: what the demo needs, the rest, and of both the runtime; then the twenty
# dearest files. No compiler cache.
# Usage: tests/build_times.sh [-j N] [DIRECTORY] [CMAKE-OPTION…]     default: one job at a time (the figures to compare), in
#        build-times, which is removed first. Leaves DIRECTORY/times.txt: user and system seconds of every compiler call.
set -euo pipefail
jobs=1
if [ "${1:-}" = -j ]; then
  jobs=$2
  shift 2
fi
if [[ ${1:-} == -* && ${1:-} != -D* ]]; then
  echo "build_times: no such option: $1 (build_times.sh [-j N] [DIRECTORY] [CMAKE-OPTION…])" >&2
  exit 2
fi
cd "$(dirname "$0")/.."
directory=${1:-build-times}
shift || true
rm -rf "$directory"
mkdir -p "$directory"
directory=$(realpath "$directory")
times=$directory/times.txt
: >"$times"
log=$directory/build.log

cat >"$directory/launch" <<'LAUNCH'
#!/usr/bin/env bash
# Runs a compiler call and notes its user and system seconds and what it makes.
TIMEFORMAT='%U %S'
exec 3>&2
seconds=$({ time "$@" 1>&3 2>&3; } 2>&1)
result=$?
for ((i = 1; i <= $#; i++)); do
  if [ "${!i}" = -o ]; then
    ((i++))
    echo "$seconds ${!i}" >>"$(dirname "$0")/times.txt"
    break
  fi
done
exit $result
LAUNCH
chmod +x "$directory/launch"

cmake -G Ninja -S . -B "$directory" -DSINEW_CCACHE=OFF -DCMAKE_CXX_COMPILER_LAUNCHER="$directory/launch" \
  -DCMAKE_CXX_LINKER_LAUNCHER="$directory/launch" "$@" >"$log"

stage() {  # stage NAME TARGET…: builds it and prints what that cost
  local name=$1 begin
  shift
  begin=$(date +%s)
  if ! /usr/bin/env bash -c 'ninja -C "$0" -j "$@" && times >"$0/stage"' "$directory" "$jobs" "$@" >>"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "build_times: the build failed (whole log: $log)" >&2
    exit 1
  fi
  # The second line is what the children used: minutes and seconds, user then system.
  awk -v name="$name" -v wall=$(($(date +%s) - begin)) \
    'NR == 2 { split($1, u, /[ms]/); split($2, s, /[ms]/); user = 60 * u[1] + u[2]; kernel = 60 * s[1] + s[2]
               printf "%-28s %7.0f s processor (%.0f user), %d s\n", name, user + kernel, user, wall }' "$directory/stage"
}

stage "what the demo needs" sinew_cli
stage "the rest" all
awk '$3 ~ /^runtime\// { user += $1; kernel += $2 } END { printf "%-28s %7.0f s processor (%.0f user)\n", "the runtime, of both", user + kernel, user }' "$times"
echo
echo "user seconds of the twenty dearest files:"
grep '\.o$' "$times" | sort -rn | head -n 20 | awk '{ sub(/CMakeFiles\//, "", $3); sub(/[A-Za-z_0-9]*\.dir\//, "", $3); sub(/\.o$/, "", $3); printf "%7.1f  %s\n", $1, $3 }'
grep '\.o$' "$times" | awk '{ n++; s += $1 } END { printf "%d files, %.0f user seconds\n", n, s }'
