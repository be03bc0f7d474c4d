#!/usr/bin/env bash
# Feeds the readers of manifests, sessions, traces, volume headers and transfer functions with made-up input for a
# bounded time each, under the address and undefined-behaviour sanitizers. For a nightly job:
#   tools/fuzz.sh [SECONDS_PER_TARGET] [TARGET…]
# What it finds lies in build/fuzz/found and is printed; put it into tests/fuzz/cases once it is fixed. Exit code 1
# if anything was found.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-300}
shift || true
targets=${*:-manifest session trace volume transfer_function}
build=${BRACE_FUZZ_BUILD:-build/fuzz}

missing=""
for package in clang libclang-rt-14-dev; do
  dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
done
if [ -n "$missing" ]; then
  echo "fuzz: installing$missing"
  run=""
  [ "$(id -u)" -eq 0 ] || run=sudo
  $run apt-get update -qq
  # shellcheck disable=SC2086
  $run env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
fi

flags="-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer"
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DCMAKE_C_FLAGS="-O1 $flags" -DCMAKE_CXX_FLAGS="-O1 $flags" -DBRACE_BUILD_FUZZERS=ON >/dev/null
# shellcheck disable=SC2086
cmake --build "$build" --target $(printf 'fuzz_%s ' $targets) >"$build/build.log" 2>&1 || {
  tail -n 40 "$build/build.log"
  exit 1
}

# Debian's toml++ is not built with the sanitizer, which then misreads the bounds of containers that it fills.
export ASAN_OPTIONS=detect_container_overflow=0
found=0
for target in $targets; do
  mkdir -p "$build/corpus/$target" "$build/found/$target"
  echo "fuzz: $target for $seconds s"
  if ! "$build/fuzz/fuzz_$target" "$build/corpus/$target" "tests/fuzz/cases/$target" -max_total_time="$seconds" \
    -max_len=65536 -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$build/found/$target/" >"$build/found/$target.log" 2>&1; then
    found=1
    echo "fuzz: $target: FOUND SOMETHING; the end of $build/found/$target.log:"
    tail -n 40 "$build/found/$target.log"
  else
    grep -E "stat::number_of_executed_units|stat::peak_rss_mb" "$build/found/$target.log"
  fi
done
exit $found
