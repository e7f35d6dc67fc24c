# To be sourced by scripts that build: says how far a long command is, in one line that changes on a terminal, now and
# then elsewhere (a log). What the command itself says goes into its log file.
# Usage: COMMAND 2>&1 | progress_of_ninja LOG WHAT        (progress_of_ctest: the same)

progress_line() {  # progress_line TEXT: at most once a second on a terminal, every $progress_pause s elsewhere
  if [ -t 2 ]; then
    [ "$SECONDS" = "${progress_said:-}" ] || printf '\r\033[K%s' "$1" >&2
    progress_said=$SECONDS
  elif [ $((SECONDS - ${progress_said:=$SECONDS})) -ge "${progress_pause:-30}" ]; then
    echo "$1" >&2
    progress_said=$SECONDS
  fi
}

progress_end() { [ ! -t 2 ] || printf '\r\033[K' >&2; }

time_left() {  # time_left DONE ALL SECONDS: in words; nothing while little is known
  if [ "$3" -lt 5 ] || [ "$1" -lt 5 ]; then return; fi
  local seconds=$(($3 * ($2 - $1) / $1))
  if [ $seconds -ge 90 ]; then echo ", about $(((seconds + 30) / 60)) min left"; else echo ", about $seconds s left"; fi
}

progress_of() {  # progress_of LOG WHAT PATTERN: the pattern's first two groups are how many are done, and of how many
  local line start=$SECONDS progress_said=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ $3 ]] || continue
    progress_line "$2: ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}$(time_left "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" $((SECONDS - start)))"
  done >"$1"
  progress_end
}

progress_of_ninja() { progress_of "$1" "$2" '^\[([0-9]+)/([0-9]+)\]'; }
progress_of_ctest() { progress_of "$1" "$2" '^ *([0-9]+)/([0-9]+) Test '; }
