# Sourced: runs pose_hashes, and compares what it printed on several machines.

without_fma=glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-AVX512DQ,-AVX512BW

# run_as_processors FOLDER POSE_HASHES ASSET GRAPH: FOLDER/MACHINE holds the lines; sets `machines` to those that this one
# can be taken for: with SSE2 alone in the runtime's kernels, with AVX2, with AVX-512; and "old", SSE2 alone in the C
# library's functions, too.
run_as_processors() {
  local folder=$1 result processor
  shift
  machines=()
  for processor in baseline avx2 avx512 old; do
    result=0
    if [ $processor = old ]; then
      GLIBC_TUNABLES=$without_fma "$@" --processor baseline >"$folder/old" 2>"$folder/old.log" || result=$?
    else
      "$@" --processor $processor >"$folder/$processor" 2>"$folder/$processor.log" || result=$?
    fi
    case $result in
      0) machines+=($processor) ;;
      77) ;;
      *) cat "$folder/$processor.log" >&2; return 1 ;;
    esac
  done
}

# table FOLDER FIRST OTHER…: prints which lines of FOLDER/OTHER are those of FOLDER/FIRST, as Markdown. Fails, and names
# scene, precision and machines, where they differ.
table() {
  local folder=$1
  shift
  (cd "$folder" && awk -v machines="$*" '
    BEGIN {
      count = split(machines, machine, " ")
    }
    FNR == 1 { ++file }
    { sub(/\r$/, "") }  # of Windows
    { hash[$1 " " $2, file] = $3 }
    file == 1 { line[++lines] = $1 " " $2 }
    END {
      printf "| scene |"; for (m = 1; m <= count; ++m) printf " %s |", machine[m]
      printf "\n|---|"; for (m = 1; m <= count; ++m) printf "---|"
      print ""
      for (n = 1; n <= lines; ++n) {
        printf "| %s |", line[n]
        for (m = 1; m <= count; ++m) {
          same = hash[line[n], m] == hash[line[n], 1]
          printf " %s |", same ? "=" : "differs"
          if (!same)
            faults[++wrong] = line[n] " differs: " machine[1] " " hash[line[n], 1] ", " machine[m] " " hash[line[n], m]
        }
        print ""
      }
      fflush()
      for (n = 1; n <= wrong; ++n) print faults[n] > "/dev/stderr"
      exit lines == 0 || wrong > 0
    }' "$@")
}
