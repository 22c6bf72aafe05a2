# shellcheck shell=bash
# For scripts to source, first of all: with -h or --help as its first argument, a script prints its head, and ends.

case ${1:-} in
  -h | --help)
    sed -n '2,/^[^#]/{/^#/!d;s/^# \{0,1\}//;p}' "$0"
    exit 0
    ;;
esac
