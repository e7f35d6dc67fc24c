#!/usr/bin/env bash
# Draws the pictures of README.md: a strip of moments of each scene, and of some by several schemes, one below the other.
# Needs ffmpeg and the target sinew_cli. Usage: assets/scenes/talk/pictures.sh [build/sinew]
set -euo pipefail
cd "$(dirname "$0")"
sinew=$(realpath "${1:-../../../build/sinew}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p pictures

# row NAME SCENE SCHEME SECONDS…: a strip, 400 pixels a moment; so high in the middle as $height says
height=300
row() {
  local name=$1 scene=$2 scheme=$3 inputs=() moment n=0
  shift 3
  for moment in "$@"; do
    "$sinew" render "$scene.json" --scheme "$scheme" --start "$moment" --no-overlay --theme dark --size 400x300 \
      -o "$work/$name.$n.png" >/dev/null
    inputs+=(-i "$work/$name.$n.png")
    n=$((n + 1))
  done
  ffmpeg -nostdin -loglevel error -y "${inputs[@]}" -filter_complex "hstack=inputs=$n,crop=iw:$height" "$work/$name.png"
}

# picture NAME ROW…: strips below each other, as JPEG
picture() {
  local name=$1 inputs=() strip n=0
  shift
  for strip in "$@"; do
    inputs+=(-i "$work/$strip.png")
    n=$((n + 1))
  done
  local stack="vstack=inputs=$n"
  [ $n -gt 1 ] || stack=null
  ffmpeg -nostdin -loglevel error -y "${inputs[@]}" -filter_complex "$stack" -q:v 6 "pictures/$name.jpg"
}

strip() { # strip SCENE SECONDS…: as the scene file has it, by the runtime's scheme
  local scene=$1
  shift
  row "$scene" "$scene" bossak "$@"
  picture "$scene" "$scene"
}

height=90
for scheme in forward_euler semi_implicit bdf1; do row "spring_$scheme" stiff_spring $scheme 0.05 0.25 0.4 0.5; done
height=300
picture stiff_spring spring_forward_euler spring_semi_implicit spring_bdf1
strip hinge 0 0.3 0.55 0.8
strip linked_bodies 0 0.4 0.8 1.2
strip figure 0 0.75 1.6 2.4
row torque_semi torque_limit semi_implicit 2 3 3.6 4.5
row torque_runtime torque_limit bossak 2 3 3.6 4.5
picture torque_limit torque_semi torque_runtime
strip one_axis 0 0.6 0.8 1.1
for scheme in forward_euler semi_implicit bossak; do row "box_$scheme" stiff_contact $scheme 0.1 0.4 0.65 0.9; done
picture stiff_contact box_forward_euler box_semi_implicit box_bossak
strip bar 0 0.5 1 1.5
strip handcuffs 0.5 1.5 1.9 2.5
strip calves 0.5 1.2 1.7 2.5
row wrong_bdf1 wrong_root bdf1 0 0.0167 0.0334 0.1
row wrong_runtime wrong_root bossak 0 0.0167 0.0334 0.1
picture wrong_root wrong_bdf1 wrong_runtime
strip limp 0.4 0.8 1.1 2.5
row baked_talk baked_as_in_the_talk bossak 0.25 0.33 0.5 0.6
row baked_own baked bossak 0.25 0.33 0.5 0.6
picture baked baked_talk baked_own
