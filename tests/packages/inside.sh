#!/usr/bin/env bash
# The checks of use_test, in the clean Debian.
# shellcheck disable=SC2016,SC2317 # check() calls functions, and shells expand their own text
set -uo pipefail
cd /use || exit 1
failed=0

# check NAME COMMAND...
check() {
  local name=$1
  shift
  if "$@" >/use/log 2>&1; then
    echo "ok      $name"
  else
    echo "FAILED  $name"
    tail -n 20 /use/log
    failed=$((failed + 1))
  fi
}
install() { apt-get install -y --no-install-recommends "$@"; }
model=/usr/share/tactree/models/ripple.blob

check "apt install ./*.deb" install ./*.deb
check "six packages" test "$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' '*tactree*' | grep -c ' installed$')" = 6
check "one command touches a model" tactree simulate $model --seconds 1 --trace host.csv --json host.json
touches() { python3 -c 'import json; s = json.load(open("host.json")); assert s["force_max_N"] > 0.1, s'; }
check "with a force" touches
check "a scan becomes a model" sh -c 'python3 examples/python/ripple.py >ripple.ply && tactree build ripple.ply -o own.blob && cmp own.blob '$model
amf() {
  python3 - >cube.amf <<'END'
corners = [(x, y, z) for x in (0, 20) for y in (0, 20) for z in (0, 20)]
sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
print('<?xml version="1.0"?><amf unit="millimeter"><object id="0"><mesh><vertices>')
for x, y, z in corners:
    print(f"<vertex><coordinates><x>{x}</x><y>{y}</y><z>{z}</z></coordinates></vertex>")
print("</vertices><volume>")
for a, b, c, d in sides:
    for u, v, w in ((a, b, c), (a, c, d)):
        print(f"<triangle><v1>{u}</v1><v2>{v}</v2><v3>{w}</v3></triangle>")
print("</volume></mesh></object></amf>")
END
  tactree build cube.amf -o cube.blob && tactree check cube.blob
}
check "a mesh, by the program that imports it" amf
check "manual pages" sh -c 'zcat /usr/share/man/man1/tactree-build.1.gz | grep -q spacing &&
  zcat /usr/share/man/man1/tactree.1.gz | grep -q simulate && zcat /usr/share/man/man1/tactree-controller.1.gz | grep -q dry'
check "completion" bash -c 'source /usr/share/bash-completion/completions/tactree
  COMP_WORDS=(tactree simu) COMP_CWORD=1; _tactree; [ "${COMPREPLY[*]}" = simulate ]'
check "udev rule" grep -q 'ff5401' /usr/lib/udev/rules.d/70-tactree.rules
page() {
  local result=1
  tactree view "$model" --page-port 8791 >view.log 2>&1 &
  for _ in $(seq 100); do
    if python3 -c 'import urllib.request as u; assert b"assets/page.js" in u.urlopen("http://127.0.0.1:8791/").read()'; then
      result=0
      break
    fi
    sleep 0.2
  done
  kill %1
  cat view.log
  return "$result"
}
check "page of view" page
check "Python computes what the program does" python3 python_check.py $model
check "controller" sh -c 'tactree-controller --version && test -e /usr/share/tactree/boards/raspberry-pi-5.json'
check "service is there and not enabled" sh -c 'grep -q tactree-controller $(dpkg -L tactree-controller | grep "\.service$") &&
  ! ls /etc/systemd/system/*/tactree-controller.service'

check "compilers" install g++ cmake make pkg-config
check "C program, shared" sh -c 'gcc -Wall -Werror consumer/pkg_config/client.c -o client_c $(pkg-config --cflags --libs tactree-client-c) &&
  ./client_c && ldd client_c | grep libtactree-client.so.0'
check "C++ program, static" sh -c 'g++ consumer/pkg_config/client.cpp -o client_cpp $(pkg-config --cflags --libs tactree-client) &&
  ./client_cpp && ! ldd client_cpp | grep tactree'
check "builder and simulation, static" sh -c 'g++ consumer/builder/main.cpp -o builder $(pkg-config --cflags --libs tactree-builder tactree-simulation) &&
  ./builder sphere.blob && tactree check sphere.blob'
check "shared library with the core" sh -c 'g++ -shared -fPIC -Wl,-z,defs consumer/pkg_config/touch.cpp -o libtouch.so $(pkg-config --cflags --libs tactree-core) &&
  ! ldd libtouch.so | grep tactree'
# project NAME FOLDER: by find_package
project() {
  cmake -S "$2" -B "/use/build-$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=/usr && cmake --build "/use/build-$1" &&
    ctest --test-dir "/use/build-$1" --output-on-failure
}
check "project with core" project core consumer/core
check "project with builder and simulation" project builder consumer/builder
check "project with the client" project touch examples/touch
check "project with the shared client" project client_c consumer/client_c
check "which needs the shared library" sh -c 'ldd build-client_c/consumer | grep libtactree-client.so.0'

check "emulator" install qemu-system-arm
check "firmware in the emulator" tactree simulate $model --board mps2-an386 --seconds 1 --trace board.csv --json board.json
check "with the same forces to the bit" cmp host.csv board.csv
counts() {
  python3 -c 'import json; n = json.load(open("board.json"))["instructions"]; assert n["max"] > n["mean"] > 100, n["max"]'
}
check "and its instructions are counted" counts

check "apt purge" apt-get purge -y '*tactree*'
check "leaves nothing" test -z "$(find / -xdev -path /use -prune -o -path /proc -prune -o -name '*tactree*' -print)"
exit $((failed > 0))
