# shellcheck shell=bash
# For the benchmarks to source: they run at the root of the sources, and have a directory `work` until they end.
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source scripts/release_build.sh
models_dir=${MESHHIER_MODELS:-../shared/models}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "benchmark: $*" >&2
  exit 2
}

# Sets `files` to the models that are there of these.
find_models() {
  local model
  files=()
  for model in "$@"; do
    [[ ! -f $models_dir/$model ]] || files+=("$models_dir/$model")
  done
}

# A table in Markdown: a file of its rows, and the names of its columns, of which the first is text.
print_table() {
  local rows=$1
  shift
  printf '| %s ' "$@"
  printf '|\n|---'
  printf '|%.0s---:' "${@:2}"
  echo '|'
  cat "$rows"
}
