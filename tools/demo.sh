#!/usr/bin/env bash
# Makes out/demo.mp4 (with its telemetry CSV and plot): the project's own character, or any file that Sinew can convert.
# Usage: tools/demo.sh [FILE]
set -euo pipefail
source_file=${1:-}
if [ -n "$source_file" ]; then
  [ -f "$source_file" ] || { echo "demo: $source_file: no such file" >&2; exit 1; }
  source_file=$(realpath "$source_file")
fi
cd "$(dirname "$0")/.."

tools/setup.sh
mkdir -p build out
echo "building …" >&2
if ! { cmake -G Ninja -S . -B build && ninja -C build sinew_cli; } >build/build.log 2>&1; then
  tail -n 30 build/build.log >&2
  echo "demo: the build failed (whole log: build/build.log)" >&2
  exit 1
fi
sinew=build/sinew

# Nothing changed since the last run: nothing to do.
stamp=$(sha256sum "$sinew" assets/character/* assets/scenes/*.json ${source_file:+"$source_file"} | sha256sum | cut -d' ' -f1)
if [ -f out/demo.mp4 ] && [ -f out/demo.csv ] && [ -f out/demo.png ] && [ "$(cat out/.stamp 2>/dev/null)" = "$stamp" ]; then
  echo "out/demo.mp4, out/demo.csv and out/demo.png are up to date"
  exit 0
fi

if [ -n "$source_file" ]; then
  echo "converting $source_file …" >&2
  "$sinew" convert "$source_file" -o out/demo.sinew >out/convert.log
  echo "simulating and rendering …" >&2
  "$sinew" render out/demo.sinew --demo --telemetry out/demo.csv -o out/demo.mp4 >/dev/null
else
  echo "converting the project's character and Debian's motion capture …" >&2
  "$sinew" convert assets/character/mannequin.glb --options assets/character/mannequin.json -o out/mannequin.sinew >out/convert.log
  "$sinew" convert /usr/share/assimp/models/BVH/01_01.bvh -o out/mocap.sinew >>out/convert.log
  cp assets/scenes/demo.json out/demo.json
  echo "simulating and rendering …" >&2
  "$sinew" render out/demo.json --telemetry out/demo.csv -o out/story.mp4 >/dev/null
  "$sinew" render out/mocap.sinew --demo --mode xray --telemetry out/mocap.csv -o out/mocap.mp4 >/dev/null
  # Both halves come from the same encoder: joined without encoding again.
  printf "file '%s'\n" story.mp4 mocap.mp4 >out/halves.txt
  ffmpeg -nostdin -loglevel error -y -f concat -i out/halves.txt -c copy -movflags +faststart out/joined.mp4
  mv out/joined.mp4 out/demo.mp4
  rm -f out/halves.txt out/story.mp4 out/mocap.mp4
fi
echo "$stamp" >out/.stamp
echo "out/demo.mp4: video; out/demo.csv and out/demo.png: telemetry and its plot"
