#!/usr/bin/env bash
# Makes out/demo.mp4 (with its telemetry CSV and plot): the project's own character, or any file that Sinew can convert.
# Says on standard error what it does; its only line on standard output is the last one.
# Usage: tools/demo.sh [FILE]
set -euo pipefail
exec </dev/null # nothing below may wait for, or stumble over, what standard input is

say() { printf '%s\n' "$*" >&2; }
fail() {
  say "demo: $*"
  exit 1
}

source_file=${1:-}
if [ $# -gt 0 ]; then
  [ -e "$source_file" ] || fail "$source_file: no such file"
  [ -f "$source_file" ] && [ -r "$source_file" ] || fail "$source_file: cannot be read as a file"
  source_file=$(realpath "$source_file")
fi
cd "$(dirname "$0")/.."
. tools/progress.sh

work=out/.making
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

# The build folder is also that of tests/run.sh, which asks for tests and samples: they are left out where this is the
# first to configure it, or the first to succeed, and never taken away.
build() {
  mkdir -p build
  if [ ! -f build/CMakeCache.txt ] || [ ! -f build/build.ninja ]; then
    say "configuring …"
    cmake -G Ninja -S . -B build -DSINEW_TESTS=OFF -DSINEW_SAMPLES=OFF >build/build.log 2>&1 || return 1
  fi
  say "building …"
  progress_pause=10
  ninja -C build sinew_cli 2>&1 | progress_of_ninja build/build.log "building"
}

tools/setup.sh
if ! build; then
  tail -n 30 build/build.log >&2
  culprit=$(grep -m 1 -E '^FAILED: |CMake Error|error: ' build/build.log || true)
  fail "the build failed${culprit:+: $culprit} (whole log: build/build.log)"
fi
sinew=build/sinew

# Nothing changed since the last run: nothing to do.
mkdir -p out
stamp=$(sha256sum "$sinew" assets/character/* assets/scenes/*.json ${source_file:+"$source_file"} | sha256sum | cut -d' ' -f1)
if [ -f out/demo.mp4 ] && [ -f out/demo.csv ] && [ -f out/demo.png ] && [ "$(cat out/.stamp 2>/dev/null)" = "$stamp" ]; then
  echo "out/demo.mp4, out/demo.csv and out/demo.png are up to date"
  exit 0
fi

convert() { # convert NAME INPUT OPTIONS…
  say "converting $2 …"
  "$sinew" convert "${@:2}" -o "$work/$1.sinew" >>out/convert.log || fail "$2 could not be converted"
}
render() { # render WHAT INPUT OPTIONS…
  say "simulating and rendering $1 …"
  "$sinew" render "${@:2}" >/dev/null || fail "$1 could not be rendered"
}

# Everything is made in a folder of its own: under the final names there are whole files only, and all of one run.
rm -rf "$work"
mkdir "$work"
: >out/convert.log
if [ -n "$source_file" ]; then
  convert demo "$source_file"
  render "its video" "$work/demo.sinew" --demo --telemetry "$work/demo.csv" -o "$work/demo.mp4"
else
  convert mannequin assets/character/mannequin.glb --options assets/character/mannequin.json
  convert mocap /usr/share/assimp/models/BVH/01_01.bvh
  cp assets/scenes/demo.json "$work"
  render "the story (1 of 2)" "$work/demo.json" --telemetry "$work/demo.csv" -o "$work/story.mp4"
  render "motion capture (2 of 2)" "$work/mocap.sinew" --demo --mode xray --telemetry "$work/mocap.csv" -o "$work/mocap.mp4"
  # Both halves come from the same encoder: joined without encoding again.
  printf "file '%s'\n" story.mp4 mocap.mp4 >"$work/halves.txt"
  ffmpeg -nostdin -loglevel error -y -f concat -i "$work/halves.txt" -c copy -movflags +faststart "$work/demo.mp4" ||
    fail "ffmpeg could not join the two halves"
  rm "$work"/halves.txt "$work"/story.mp4 "$work"/mocap.mp4
fi
[ -f "$work/demo.png" ] || fail "gnuplot made no plot of the telemetry"
rm -f out/.stamp
mv "$work"/* out
echo "$stamp" >out/.stamp
echo "made out/demo.mp4 (video), out/demo.csv and out/demo.png (telemetry and its plot) in $SECONDS s"
