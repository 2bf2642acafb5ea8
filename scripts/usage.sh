# For scripts whose first comment says what they do and how to call them: it answers --help.
# shellcheck shell=bash
usage_of=$(realpath "$0")
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$usage_of"; }

# wrong_usage: ends the script with exit code 2
wrong_usage() { usage >&2; exit 2; }

case "${1:-}" in --help | -h) usage; exit 0 ;; esac
