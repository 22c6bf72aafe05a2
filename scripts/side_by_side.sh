# Parts of a check at the same time, for scripts to source.
#
#   side_by_side COMMAND...
#
# A COMMAND is shell text, of the caller's functions and variables. As many run at a time as there are processors.
# What one prints comes in one piece when it ends, and how long it took. If one fails, no other begins; when those that run have ended, the caller
# ends with 1.

# Runs one. It must not be called where bash ignores that a command fails.
side_by_side_run() {
  local logs=$1 number=$2 part=$3 status
  set +e
  SECONDS=0
  (
    set -e
    eval "$part"
  ) >"$logs/$number" 2>&1
  status=$?
  echo "== $part: $SECONDS s" >>"$logs/$number"
  flock "$logs" cat "$logs/$number"
  ((status == 0)) || echo "FAILED: $part" >&2
  exit "$status"
}

side_by_side() {
  local logs part number=0 running=0 failed=0
  logs=$(mktemp -d)
  for part in "$@"; do
    if ((running == $(nproc))); then
      wait -n || failed=1
      running=$((running - 1))
    fi
    ((failed == 0)) || break
    number=$((number + 1))
    side_by_side_run "$logs" "$number" "$part" &
    running=$((running + 1))
  done
  while ((running > 0)); do
    wait -n || failed=1
    running=$((running - 1))
  done
  rm -rf "$logs"
  ((failed == 0)) || exit 1
}

# Sets `turn` to those of the commands whose turn it is: an eighth of them with MESHHIER_TEST_SHARE="k/n", so that any eight shares in a
# row have all; all without it. The others are named.
take_turns() {
  local number=0 command
  turn=()
  for command in "$@"; do
    if [[ -z ${MESHHIER_TEST_SHARE:-} ]] || ((number % 8 == ${MESHHIER_TEST_SHARE%/*} % 8)); then
      turn+=("$command")
    else
      echo "not in this share: $command"
    fi
    number=$((number + 1))
  done
}
