#!/usr/bin/env bash
# Installs, builds and tests. Says how far it is; ends with one line (and, with CI set, ctest's own summary last).
# Usage: tests/run.sh [--all | --nightly | --format | --tidy | --sanitizers]
#   --all adds the format check, a batch on Slurm, clang-tidy (.clang-tidy) over what the last 12 commits changed, the address and undefined-behaviour sanitizers, 2000 random
#   trees, two minutes of soak, the accuracy study's report (build/study/accuracy.html), and a line with the seconds of
#   each stage; the others run that stage alone (--tidy: over every file). --nightly looks at every file with clang-tidy, builds and runs a million random calls of the C interface with
#   the sanitizers, hard cases and situations with them, a thousand killed conversions, 100000 random trees, an hour of soak in float and in double, all hard cases at full length, the page for
#   browsers, the same poses on ARM, in WebAssembly and by clang, packages, and both of the README's commands on a bare machine: hours.
#   tests/README.md says how to run one test.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/progress.sh
jobs=$(nproc)

stage() {  # stage NAME COMMAND…: says how long it took
  local name=$1 start=$SECONDS
  shift
  "$@"
  [ -z "$all" ] || echo "stage: $name: $((SECONDS - start)) s"
}

configure() {  # configure DIRECTORY CMAKE-OPTIONS…
  local directory=$1 log=$1/configure.log
  shift
  mkdir -p "$directory"
  if ! cmake -G Ninja -S . -B "$directory" "$@" >"$log" 2>&1; then
    grep -A5 'CMake Error' "$log" | head -n 40 >&2
    echo "tests: $directory could not be configured (whole log: $log)" >&2
    exit 1
  fi
}

build() {  # build DIRECTORY WHAT NINJA-ARGUMENTS…
  local directory=$1 what=$2 log=$1/build.log
  shift 2
  echo "$what …" >&2
  if ! ninja -C "$directory" -j "$jobs" "$@" 2>&1 | progress_of_ninja "$log" "$what"; then
    grep -E -A3 'error|FAILED|Error' "$log" | head -n 40 >&2
    echo "tests: $what failed (whole log: $log)" >&2
    exit 1
  fi
}

run() {  # run DIRECTORY CTEST-ARGUMENTS…
  echo "testing in $1 …" >&2
  ctest --test-dir "$1" -j "$jobs" --output-on-failure --no-tests=error "${@:2}" 2>&1 | progress_of_ctest "$1/test.log" "testing in $1" || {
    tail -n 80 "$1/test.log" >&2
    echo "tests: failed (whole log: $1/test.log)" >&2
    exit 1
  }
}

build_tests() {  # in the demo's folder: what the demo built is not built again
  configure build -DSINEW_TESTS=ON -DSINEW_SAMPLES=ON
  build build "building"
}

format() {
  git ls-files '*.cpp' '*.h' | xargs clang-format --dry-run --Werror
}

# A change of what follows makes clang-tidy look at every file again.
tidy_settings() {
  cat .clang-tidy tests/tidy/own_declarations.cpp tests/tidy/*.sh tests/run.sh
  clang-tidy --version
}

# Of the last COMMITS commits: files that changed, and one that includes each header that did. Without so much of a history: all.
changed() {  # changed COMMITS
  if ! git rev-parse -q --verify "HEAD~$1" >/dev/null; then
    git ls-files '*.cpp'
    return
  fi
  git diff --name-only --diff-filter=d "HEAD~$1" -- '*.cpp'
  local header
  git diff --name-only --diff-filter=d "HEAD~$1" -- '*.h' | while IFS= read -r header; do
    { git grep -lE "#include \"(.*/)?${header##*/}\"" -- '*.cpp' || true; } | head -n 1
  done
}

# Looks at every file, or at what the last COMMITS commits changed; the next time at those that changed or include what
# changed since. Nothing is compiled or linked: ninja and CMake only know who includes what. Without the build's
# precompiled headers: an #include of ours that is missing is found here.
tidy() {  # tidy [COMMITS]
  local settings plugin=build-tidy/own_declarations.so instead=$PWD/tests/tidy/instead_of_compiler.sh
  settings=$(tidy_settings | sha256sum)
  if [ "$settings" != "$(cat build-tidy/settings 2>/dev/null)" ]; then
    rm -rf build-tidy
    mkdir build-tidy
    g++ -std=c++17 -O1 -fno-rtti -fPIC -shared -isystem "$(llvm-config --includedir)" tests/tidy/own_declarations.cpp -o $plugin
    echo "$settings" >build-tidy/settings
  fi
  tests/tidy/clang_tidy.sh prepare
  configure build-tidy -DSINEW_CCACHE=OFF -DCMAKE_CXX_COMPILER_LAUNCHER="$instead" -DCMAKE_CXX_LINKER_LAUNCHER="$instead" \
    -DCMAKE_C_COMPILER_LAUNCHER="$instead" -DCMAKE_C_LINKER_LAUNCHER="$instead" \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DSINEW_PYTHON_BINDING=OFF -DSINEW_CSHARP_BINDING=OFF -DSINEW_RUST_BINDING=OFF \
    -DCMAKE_CXX_CLANG_TIDY="$PWD/tests/tidy/clang_tidy.sh;--quiet;--load=$PWD/$plugin;--checks=sinew-own-declarations"
  mapfile -t objects < <(ninja -C build-tidy -t targets all | sed -n 's/\.o: CXX_COMPILER.*/.o/p')
  if [ -n "${1:-}" ]; then
    changed "$1" | sort -u >build-tidy/changed
    mapfile -t objects < <(printf '%s\n' "${objects[@]}" | sed -E 's#(.*/)?CMakeFiles/[^/]*\.dir/(.*)\.o$#\1\2 &#' |
      awk 'NR == FNR { changed[$1]; next } $1 in changed { print $2 }' build-tidy/changed -)
    [ ${#objects[@]} -gt 0 ] || return 0
  fi
  build build-tidy "clang-tidy" -k 20 "${objects[@]}"
}

# Simulations that take minutes when every access is checked, of what others run through as well.
too_long_for_sanitizers='/(corner|pit|columns|hanging_bridge|cape_in_a_run|crowd_pushed|balls_at_heads|piston|cloth|wall_of_bricks|heap_of_boxes|rubble|planks|pile|slope|stairs|limp_fall|limp_fall_bdf1|limp_fall_bdf2|limp_fall_counts|crowd_of_200|same_bits_in_any_order)( |$)|^LimpFall|LimpFallStep|^AccuracyStudy|^Dial|^sample_crowd|^Tables.RunOn|^Pile|^Size|^TransitionTable|^GlobalFormulation|^SnapshotBytes|^Command.SimulateTakes|ForeignMotion|ForeignSquats|ForeignBody|AMillionRandomFrames|^Table\.|^Reference\.|References.*/(driver|suspension|bricard)|LimbsThatAPistonHasJammed|KeepsBothMomentaToRounding|LimpFallsGainNoEnergy|^Hits\.|ASmallPushIsStood|^Budget\.|^Batches\.AnimationsAreChecked|Blender'

# Of the command line: what sinew-study answers, and what takes long and is no access to memory.
asks_the_studies='^MechanismCommand|^Manners|^Batch\.|^BatchOnSlurm|BrokenJson.ReachesTheUser'

# By clang, so that its warnings are errors here, too, and as it takes a third of GCC's time. -O1: instrumented code
# compiles in three quarters of the time that it takes with -O2, its kernels in a third.
configure_sanitizers() {  # configure_sanitizers STUDIES: ON or OFF
  configure build-asan -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DSINEW_STUDIES="$1" -DSINEW_SANITIZE=ON -DSINEW_PROFILER=ON -DSINEW_ASSERTS=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -DNDEBUG"
}

# Without the studies and what tests of them (a quarter of the compiling, half of the running): hard cases and situations are
# checked so at night.
sanitizers() {
  export LSAN_OPTIONS=suppressions=$PWD/tests/leaks-of-libraries.supp:print_suppressions=0
  configure_sanitizers OFF
  stage "sanitizers: build" build build-asan "building with sanitizers"
  stage "sanitizers: tests" run build-asan -E "$too_long_for_sanitizers|$asks_the_studies"
  [ -z "${CI:-}" ] || rm -rf build-asan  # several GB that CI does not need again
}

long() {  # long NAME: a hard-cases test at the length that the environment asks for
  echo "running $1 at length …" >&2
  build/tests/hard_cases/"$1_test" >"build/$1.log" || {
    tail -n 30 "build/$1.log" >&2
    echo "tests: $1 failed at length (whole log: build/$1.log)" >&2
    exit 1
  }
}

study_accuracy() {
  echo "accuracy study …" >&2
  build/sinew study accuracy --quick -o build/study >build/accuracy.log || [ $? = 3 ] || {  # 3: busy, no presets
    tail -n 30 build/accuracy.log >&2
    echo "tests: the accuracy study failed (whole log: build/accuracy.log)" >&2
    exit 1
  }
}

# All at once: each mostly runs on one processor.
at_length() {
  local pids=() pid failed=0
  (SINEW_RANDOM_TREES=2000 long random_trees) & pids+=($!)
  (SINEW_SOAK_SECONDS=120 long soak) & pids+=($!)
  (study_accuracy) & pids+=($!)
  for pid in "${pids[@]}"; do wait "$pid" || failed=1; done
  return $failed
}

sanitize_studies() {
  configure_sanitizers ON
  build build-asan "building the studies with sanitizers" tests/hard_cases/all tests/talk/all
  for part in hard_cases talk; do run build-asan/tests/$part -E "$too_long_for_sanitizers"; done
}

fuzz_c_interface() {  # random calls, every access of theirs checked
  configure_sanitizers ON
  build build-asan "building the C interface with sanitizers" c_fuzz_test
  [ -e build-asan/sample.sinew ] || cp build/sample.sinew build-asan/  # what the tools write is the same
  echo "random calls of the C interface …" >&2
  SINEW_FUZZ_CALLS=${SINEW_FUZZ_CALLS:-1000000} build-asan/tests/c/c_fuzz_test >build/fuzz.log 2>&1 || {
    tail -n 40 build/fuzz.log >&2
    echo "tests: the C interface failed at random calls (whole log: build/fuzz.log)" >&2
    exit 1
  }
}

nightly() {
  build_tests
  tidy
  export LSAN_OPTIONS=suppressions=$PWD/tests/leaks-of-libraries.supp:print_suppressions=0
  sanitize_studies
  fuzz_c_interface
  SINEW_KILLS=1000 run build -R Folder.MayBeKilled
  SINEW_RANDOM_TREES=${SINEW_RANDOM_TREES:-100000} long random_trees
  SINEW_SOAK_SECONDS=${SINEW_SOAK_SECONDS:-3600} long soak
  echo "hard cases at full length …" >&2
  # What fails is in the table; which of it is known to, in tools/study/known_failures.cpp.
  build/sinew study stability -o build/study >build/stability.log || true
  tail -n 1 build/stability.log
  tools/setup.sh --web
  samples/web/build.sh build/sinew build/web
  run build -R '^sample_web$'
  tools/setup.sh --cross --lint
  tests/portability/cross.sh build/tests/portability/pose_hashes build/sample.sinew build/sample.sgraph
  SINEW_PACKAGES=1 run build -R 'taken_in_without_flatc|shared_layers|debian_packages'
  tests/fresh_machine.sh
}

summary() {
  tail -n 8 build/test.log
  # What the tests of passing conversions print stays in ctest's own log.
  sed -n '/^file .*error mm$/,/^\[/{/^\[/!p}' build/Testing/Temporary/LastTest.log | tee -a build/test.log
  echo "tests: $(grep -c 'Passed' build/test.log) passed, build/test.log holds the details"
  if [ -n "${CI:-}" ]; then grep -E 'tests passed|Total Test time' build/test.log; fi
}

one_stage() {  # one_stage NAME COMMAND
  all=yes
  stage "set-up" tools/setup.sh --tests --lint
  stage "$@"
  exit 0
}

case ${1:-} in
  '') all= ;;
  --all) all=yes ;;
  --format) one_stage "format" format ;;
  --tidy) one_stage "clang-tidy" tidy ;;
  --sanitizers) one_stage "sanitizers" sanitizers ;;
  --nightly) one_stage "nightly" nightly ;;
  *) echo "tests: no such option: $1 (tests/README.md lists them, and says how to run one test)" >&2; exit 2 ;;
esac
stage "set-up" tools/setup.sh --tests ${all:+--lint --farm --exports}
if [ -n "$all" ]; then
  stage "format" format
  export SINEW_SLURM=1
fi
stage "build" build_tests
stage "tests" run build
if [ -n "$all" ]; then
  stage "clang-tidy" tidy 12  # all of them by night: a quarter of an hour
  stage "sanitizers" sanitizers
  stage "at length" at_length
fi
summary
