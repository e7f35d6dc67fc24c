#!/usr/bin/env bash
# Installs what Sinew builds with, on Debian 12, as root or with sudo; quiet, and quick when everything is there.
# Usage: tools/setup.sh [--tests] [--peers]     --peers: for -DSINEW_PEERS=ON, several hundred MB
set -euo pipefail

packages=(cmake g++ ninja-build pkg-config libeigen3-dev libflatbuffers-dev flatbuffers-compiler
  libassimp-dev liburdfdom-dev libosmesa6-dev libgl-dev libcli11-dev nlohmann-json3-dev libfmt-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libavfilter-dev libcairo2-dev libpng-dev
  libjpeg62-turbo-dev zlib1g-dev libseccomp-dev libsdl2-dev libtbb-dev fonts-inter fonts-dejavu-core gnuplot-nox ffmpeg
  assimp-testmodels)
tests=(libgtest-dev libgmock-dev libmujoco-dev libbenchmark-dev ccache clang-format clang-tidy chromium valgrind)
peers=(libmujoco-dev libbullet-dev libdart-dev libode-dev libsimbody-dev libsundials-dev libboost-dev)
for option in "$@"; do
  [ "$option" = --tests ] && packages+=("${tests[@]}")
  [ "$option" = --peers ] && packages+=("${peers[@]}")
done

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
log=$(mktemp)
echo "installing ${#missing[@]} packages …" >&2
if ! { "${as_root[@]}" apt-get update && DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "setup: packages could not be installed (whole log: $log)" >&2
  exit 1
fi
rm -f "$log"
