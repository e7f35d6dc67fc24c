#!/usr/bin/env bash
# Installs, builds and tests. Quiet; ends with one line (and, with CI set, ctest's own summary last).
# Usage: tests/run.sh [--all]     --all adds the address and undefined-behaviour sanitizers, the format check and
# clang-tidy (.clang-tidy), which runs inside a build of its own: the next run looks at changed files only; then
# 2000 random trees, two minutes of soak and the accuracy study's report (build/study/accuracy.html).
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh --tests
jobs=$(nproc)

build() {  # build DIRECTORY CMAKE-OPTIONS…
  local directory=$1 log
  shift
  mkdir -p "$directory"
  log=$directory/build.log
  echo "building $directory …" >&2
  if ! { cmake -G Ninja -S . -B "$directory" "$@" && ninja -C "$directory" -j "$jobs"; } >"$log" 2>&1; then
    grep -E -A3 'error|FAILED|Error' "$log" | head -n 40 >&2
    echo "tests: the build failed (whole log: $log)" >&2
    exit 1
  fi
}

run() {  # run DIRECTORY
  ctest --test-dir "$1" -j "$jobs" --output-on-failure --no-tests=error >"$1/test.log" 2>&1 || {
    tail -n 80 "$1/test.log" >&2
    echo "tests: failed (whole log: $1/test.log)" >&2
    exit 1
  }
}

long() {  # long NAME: a hard-cases test at the length that the environment asks for
  echo "running $1 at length …" >&2
  build/tests/hard_cases/"$1_test" >"build/$1.log" || {
    tail -n 30 "build/$1.log" >&2
    echo "tests: $1 failed at length (whole log: build/$1.log)" >&2
    exit 1
  }
}

if [ "${1:-}" = --all ]; then
  git ls-files '*.cpp' '*.h' | xargs clang-format --dry-run --Werror
  build build-tidy -DCMAKE_CXX_CLANG_TIDY=clang-tidy
  export LSAN_OPTIONS=suppressions=$PWD/tests/leaks-of-libraries.supp:print_suppressions=0
  build build-asan -DSINEW_SANITIZE=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo
  run build-asan
fi
build build
run build
if [ "${1:-}" = --all ]; then
  SINEW_RANDOM_TREES=2000 long random_trees
  SINEW_SOAK_SECONDS=120 long soak
  build/sinew study accuracy --quick -o build/study >build/accuracy.log
fi
tail -n 8 build/test.log
# What the tests of passing conversions print stays in ctest's own log.
sed -n '/^file .*error mm$/,/^\[/{/^\[/!p}' build/Testing/Temporary/LastTest.log | tee -a build/test.log
echo "tests: $(grep -c 'Passed' build/test.log) passed, build/test.log holds the details"
if [ -n "${CI:-}" ]; then grep -E 'tests passed|Total Test time' build/test.log; fi
