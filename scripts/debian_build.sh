# For scripts that build in a Debian of its own, with compilers and libraries that are kept for the next time.
# shellcheck shell=bash
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# use_debian SUITE: sets `debian` to its folder, and makes it if it is not there
use_debian() {
  debian=$root/build/debian/$1
  [ -e "$debian/ready" ] || {
    "$root/scripts/clean-debian" make "$1" "$debian" build-essential ccache debhelper dpkg-dev lintian
    touch "$debian/ready"
  }
}

# inside COMMAND...: in that Debian; what was compiled before is found again
inside() { "$root/scripts/clean-debian" run "$debian" env CCACHE_DIR=/var/cache/ccache "$@"; }

# copy_sources FOLDER: what git tracks or would track
copy_sources() {
  mkdir -p "$1"
  (cd "$root" && git ls-files -z --cached --others --exclude-standard |
    tar -c --null --ignore-failed-read -T - 2>/dev/null) | tar -x -C "$1"
}
