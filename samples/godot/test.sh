#!/usr/bin/env bash
# Runs the project in Godot's headless server. Its poses and hashes must be those of the C interface alone (compare.cpp),
# the first hash that of the sample in C, and its characters must have fallen and got up. Without COMPARE: ASSET is no file,
# and Godot must say so.
# Usage: samples/godot/test.sh GODOT PROJECT ASSET [MODEL.glb COMPARE SAMPLE_C]     PROJECT: build/godot
set -euo pipefail
[ $# -eq 3 ] || [ $# -eq 6 ] ||
  { echo "usage: samples/godot/test.sh GODOT PROJECT ASSET [MODEL.glb COMPARE SAMPLE_C]" >&2; exit 2; }
godot=$1 project=$2 asset=$3
home=$(mktemp -d -p "$(dirname "$project")" godot_home.XXXXXX)  # where Godot keeps what users have
trap 'rm -rf "$home"' EXIT

run() {  # run ARGUMENT…
  env -i PATH="$PATH" HOME="$home" LANG=en_US.UTF-8 timeout 100 "$godot" --path "$project" --fixed-fps 60 \
    "--asset=$asset" "$@" >"$home/said" 2>"$home/errors"
}
fail() {
  echo "godot: $1" >&2
  cat "$home/said" "$home/errors" >&2
  exit 1
}
expect() {  # expect FILE WORDS
  grep -qF -- "$2" "$home/$1" || fail "\"$2\" is missing in what Godot says"
}

if [ $# -eq 3 ]; then
  if run; then fail "$asset was not refused"; fi
  expect errors "$asset: no such file"
  expect errors "the hero has no bones"
  cat "$home/errors"
  exit 0
fi

model=$4 compare=$5 sample=$6
run "--out=$home/poses" "--model=$model" || fail "the run failed"
! grep -q ERROR "$home/errors" || fail "there are errors"
cat "$home/said"
"$compare" "$asset" "$home/poses" | tee "$home/compared" || fail "poses differ from the run in C"
hashes() { sed -n 's/^pose hash //p' "$1"; }
[ "$(hashes "$home/said")" = "$(hashes "$home/compared")" ] || fail "hashes differ from the run in C"
[ "$(hashes "$home/said" | head -n 1)" = "$("$sample" "$asset" | sed -n 's/^pose hash //p')" ] ||
  fail "the hash of three seconds is not that of the sample in C"
expect said "the ball hits"
expect said "frame 420: Hero's pelvis is at 0.1"
expect said "frame 420: Bystander's pelvis is at 0.1"
expect said "frame 600: Hero's pelvis is at 0.94 m, on the animation"
expect said "frame 600: Bystander's pelvis is at 0.95 m, on the animation"
