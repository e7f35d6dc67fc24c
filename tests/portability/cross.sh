#!/usr/bin/env bash
# Builds pose_hashes for other machines, runs it there as far as an emulator of them is installed, and compares every line
# with what this machine prints with each of its instruction sets.
# Usage: tests/portability/cross.sh POSE_HASHES ASSET.sinew GRAPH.sgraph [TARGET…]
#   TARGET: aarch64, mingw, wasm, clang; without one, all of which the compiler is installed
#   (tools/setup.sh --cross --web --lint)
# Works in build-cross, where the table that it prints stays as table.md. Exits with 1 and names scene, precision and
# machines where they differ or a target is not built, with 77 where no target could be tried.
set -euo pipefail
[ $# -ge 3 ] || { echo "usage: tests/portability/cross.sh POSE_HASHES ASSET.sinew GRAPH.sgraph [TARGET…]" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
. "$here/compare.sh"
program=$(realpath "$1") asset=$(realpath "$2") graph=$(realpath "$3")
shift 3
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(aarch64 mingw wasm clang)
folder=$here/../../build-cross
mkdir -p "$folder/lines" "$folder/headers"
folder=$(cd "$folder" && pwd)
rm -f "$folder"/lines/*
ln -sfn /usr/include/flatbuffers "$folder/headers/flatbuffers"  # alone: other headers of the host are not the target's

installed() {  # installed TARGET PROGRAM…
  local target=$1 name
  shift
  for name in "$@"; do
    if ! command -v "$name" >/dev/null; then
      echo "skipped: $target: $name is not installed (tools/setup.sh --cross, --web or --lint)" >&2
      return 1
    fi
  done
}

build() {  # build TARGET NINJA-TARGETS -- CMAKE-OPTIONS…: with warnings as errors
  local target=$1 wanted=$2 log=$folder/$1.log
  shift 3
  echo "building for $target …" >&2
  if ! { cmake -G Ninja -S "$here/../.." -B "$folder/$target" -DSINEW_TOOLS=OFF -DSINEW_TESTS=OFF -DSINEW_SAMPLES=OFF \
    -DSINEW_POSE_HASHES=ON -DSINEW_PYTHON_BINDING=OFF -DSINEW_CSHARP_BINDING=OFF -DSINEW_RUST_BINDING=OFF "$@" &&
    ninja -C "$folder/$target" -j "$(nproc)" $wanted; } >"$log" 2>&1; then
    grep -E -A5 'error|CMake Error|FAILED' "$log" | head -n 40 >&2
    echo "cross.sh: $target is not built (whole log: $log)" >&2
    return 1
  fi
}

lines() {  # lines MACHINE COMMAND…: what it prints about the scenes
  local machine=$1
  shift
  echo "running: $machine …" >&2
  if ! "$@" "$asset" "$graph" >"$folder/lines/$machine" 2>"$folder/$machine.run.log"; then
    rm "$folder/lines/$machine"
    tail -n 5 "$folder/$machine.run.log" >&2
    echo "cross.sh: pose_hashes does not run on $machine" >&2
    return 1
  fi
  machines+=("$machine")
}

aarch64() {
  build aarch64 pose_hashes -- -DCMAKE_TOOLCHAIN_FILE="$here/aarch64.cmake" -DSINEW_FLATBUFFERS="$folder/headers" &&
    lines aarch64 qemu-aarch64 -L /usr/aarch64-linux-gnu "$folder/aarch64/tests/portability/pose_hashes"
}
# Statically, so that it asks for no library; the C interface's DLL is built as well.
mingw() {
  build mingw all -- -DCMAKE_TOOLCHAIN_FILE="$here/mingw.cmake" -DSINEW_FLATBUFFERS="$folder/headers" || return
  if ! command -v wine >/dev/null; then
    echo "skipped: mingw is built and not run: wine is not installed (tools/setup.sh --cross)" >&2
    return
  fi
  lines mingw env WINEDEBUG=-all WINEPREFIX="$folder/wine" wine "$folder/mingw/tests/portability/pose_hashes.exe"
}
# As samples/web builds the runtime. Debian's emscripten takes a newer node for a browser where that has fetch().
wasm() {
  local log=$folder/wasm.log node=(node)
  node --no-experimental-fetch -e '' 2>/dev/null && node+=(--no-experimental-fetch)
  echo "building for wasm …" >&2
  if ! { NODE_PATH=/usr/share/nodejs emcmake cmake -G Ninja -S "$here/../../samples/web" -B "$folder/wasm" -DCMAKE_BUILD_TYPE=Release \
    -DSINEW_POSE_HASHES=ON && NODE_PATH=/usr/share/nodejs ninja -C "$folder/wasm" -j "$(nproc)" pose_hashes; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "cross.sh: wasm is not built (whole log: $log)" >&2
    return 1
  fi
  lines wasm "${node[@]}" "$folder/wasm/sinew/tests/portability/pose_hashes.js"
}
clang() {
  build clang all -- -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ &&
    lines clang "$folder/clang/tests/portability/pose_hashes"
}

declare -A needs=([aarch64]="aarch64-linux-gnu-g++ qemu-aarch64" [mingw]="x86_64-w64-mingw32-g++-posix" [wasm]="emcmake node" [clang]="clang++")
run_as_processors "$folder/lines" "$program" "$asset" "$graph"
tried=0 result=0
for target in "${targets[@]}"; do
  [ -n "${needs[$target]:-}" ] || { echo "cross.sh: no such target: $target (there are aarch64, mingw, wasm and clang)" >&2; exit 2; }
  installed "$target" ${needs[$target]} || continue
  tried=$((tried + 1))
  "$target" || result=1
done
[ $tried -gt 0 ] || exit 77
rm -f "$folder"/lines/*.log
table "$folder/lines" "${machines[@]}" | tee "$folder/table.md" || result=1
exit $result
