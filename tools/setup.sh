#!/usr/bin/env bash
# Installs what Sinew builds with, on Debian 12, as root or with sudo; silent, and quick, when everything is there.
# Usage: tools/setup.sh [--tests] [--lint] [--farm] [--exports] [--peers] [--web] [--cross]
#   --tests: what the tests need     --lint: clang with its sanitizers, clang-format, clang-tidy and doxygen
#   --farm: Slurm, for its test      --exports: what tests open exported files with (Blender, and by npm, where that is, a validator)
#   --peers: for -DSINEW_PEERS=ON, several hundred MB     --web: for samples/web, the same
#   --cross: compilers for ARM and Windows, and what runs their programs, for tests/portability
set -euo pipefail
. "$(dirname "$0")/progress.sh"

# ccache and lld change the command lines of the build: they are there for the demo and for the tests, or what one of
# them built would be built again for the other.
packages=(cmake g++ ninja-build pkg-config ccache lld libeigen3-dev libflatbuffers-dev flatbuffers-compiler
  libassimp-dev liburdfdom-dev libtinyxml2-dev libosmesa6-dev libgl-dev libcli11-dev nlohmann-json3-dev libfmt-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libavfilter-dev libcairo2-dev libpng-dev
  libjpeg62-turbo-dev zlib1g-dev libseccomp-dev libsdl2-dev libtbb-dev fonts-inter fonts-dejavu-core gnuplot-nox ffmpeg
  assimp-testmodels)
tests=(libgtest-dev libgmock-dev libmujoco-dev libbenchmark-dev chromium valgrind zsh fish mandoc python3 python3-numpy
  mono-mcs mono-runtime godot3-server gdb)
lint=(clang clang-format clang-tidy libclang-rt-dev libclang-dev llvm-dev doxygen)
farm=(slurm-wlm munge)
exports=(blender)
peers=(libmujoco-dev libbullet-dev libdart-dev libode-dev libsimbody-dev libsundials-dev libboost-dev)
web=(emscripten chromium brotli)
cross=(g++-aarch64-linux-gnu qemu-user g++-mingw-w64-x86-64-posix wine wine64)
command -v npm >/dev/null || web+=(npm)  # another's will do

missing() {  # missing PACKAGE…: those that are not installed
  comm -23 <(printf '%s\n' "$@" | sort -u) \
    <(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null | sed -n 's/ installed$//p' | sort -u)
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

may_install() {  # may_install PACKAGE…: a password is asked for here, while nothing hides the question
  [ "$(id -u)" -eq 0 ] && return
  if ! command -v sudo >/dev/null; then
    echo "setup: this needs root or sudo, and there is neither; to be installed by someone who may: apt-get install $*" >&2
    exit 1
  fi
  if ! sudo true; then
    echo "setup: sudo refused; to be installed by someone who may: apt-get install $*" >&2
    exit 1
  fi
}

progress_of_apt() {  # progress_of_apt LOG: apt's own words count what it fetches, unpacks and sets up
  local line all='?' fetched=0 unpacked=0 ready=0 progress_pause=10 progress_said=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line"
    case $line in
      *' newly installed, '*) [[ $line =~ ([0-9]+)\ upgraded,\ ([0-9]+)\ newly ]] && all=$((BASH_REMATCH[1] + BASH_REMATCH[2])) ;;
      'Get:'*) [ "$all" = '?' ] || fetched=$((fetched + 1)) ;;
      'Unpacking '*) unpacked=$((unpacked + 1)) ;;
      'Setting up '*) ready=$((ready + 1)) ;;
    esac
    [ "$all" = '?' ] || progress_line "of $all packages: $fetched fetched, $unpacked unpacked, $ready ready"
  done >"$1"
  progress_end
}

install() {  # install PACKAGE…
  local log
  log=$(mktemp)
  echo "installing $# packages and what they need …" >&2
  # env: sudo passes no variables on. C.UTF-8: the words that are counted.
  if ! { as_root apt-get update && as_root env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    apt-get install -y --no-install-recommends "$@"; } 2>&1 | progress_of_apt "$log"; then
    tail -n 20 "$log" >&2
    echo "setup: packages could not be installed (whole log: $log): $*" >&2
    exit 1
  fi
  rm -f "$log"
}

validator=
for option in "$@"; do
  case $option in
    --tests) packages+=("${tests[@]}") ;;
    --lint) packages+=("${lint[@]}") ;;
    --farm) packages+=("${farm[@]}") ;;
    --exports)
      packages+=("${exports[@]}")
      validator=gltf-validator@2.0.0-dev.3.10
      ;;
    --peers) packages+=("${peers[@]}") ;;
    --web) packages+=("${web[@]}") ;;
    --cross) packages+=("${cross[@]}") ;;
    *) echo "setup: no such option: $option (there are --tests, --lint, --farm, --exports, --peers, --web and --cross)" >&2; exit 2 ;;
  esac
done
mapfile -t wanted < <(missing "${packages[@]}")
if [ ${#wanted[@]} -gt 0 ]; then
  may_install "${wanted[@]}"
  install "${wanted[@]}"
fi
if [ -n "$validator" ] && command -v npm >/dev/null && ! npm ls -g "$validator" >/dev/null 2>&1; then
  as_root npm install -g --silent "$validator" >&2 || echo "setup: no $validator; its tests are skipped" >&2
fi
