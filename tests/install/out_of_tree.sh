#!/usr/bin/env bash
# out_of_tree.sh CMAKE BUILD_FOLDER CC: installs what BUILD_FOLDER has built into a temporary prefix, moves that
# prefix, and makes, builds, checks and runs stages of both forms from there.
set -euo pipefail
cmake=$1 build=$2 cc=$3
source=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset BRACE_DATA_DIR BRACE_PLUGIN_PATH CFLAGS CXXFLAGS LDFLAGS
export XDG_CACHE_HOME="$work/cache"

fail() { echo "out_of_tree: $*" >&2; exit 1; }
# expect_exit CODE COMMAND…: standard error goes to $work/stderr
expect_exit() {
  local wanted=$1 code=0
  shift
  "$@" >"$work/stdout" 2>"$work/stderr" || code=$?
  [ "$code" = "$wanted" ] || { cat "$work/stdout" "$work/stderr" >&2; fail "'$*' ended with $code, not $wanted"; }
}
has() { grep -qF -e "$2" "$1" || { head -c 4000 "$1" >&2; fail "$1 lacks '$2'"; }; }
lacks() { ! grep -qF -e "$2" "$1" || fail "$1 has '$2'"; }

before=$(stat -c %Y "$build/bin/brace")
expect_exit 0 "$cmake" --install "$build" --prefix "$work/first"
[ "$(stat -c %Y "$build/bin/brace")" = "$before" ] || fail "installing built the program anew"
mv "$work/first" "$work/prefix"  # the tree may be moved
prefix=$work/prefix
brace=$prefix/bin/brace
for file in include/brace/brace_stage.h share/brace/glsl/brace/ray.glsl share/brace/stages/cast/dvr/dvr.glsl; do
  [ -f "$prefix/$file" ] || fail "$file is not installed"
done
[ -d "$prefix/lib/brace/plugins" ] || fail "there is no place for plug-ins"
! find "$prefix" -type l | grep -q . || fail "the installed tree has links into the source tree"
! find "$prefix" -name '*.so' ! -path "$prefix/lib/brace/plugins/native_cast.so" | grep -q . ||
  fail "example plug-ins are installed"
cd "$work"

echo "- GLSL: new-stage, edit, run, check-stage"
expect_exit 0 "$brace" new-stage cast my_cast --glsl
expect_exit 2 "$brace" new-stage cast my_cast --glsl
has stderr "is there already"
sed -i 's/brace_transfer_colour(coordinate);/brace_transfer_colour(coordinate).bgr;/' my_cast/my_cast.glsl
has my_cast/my_cast.glsl .bgr
(cd my_cast && expect_exit 0 "$brace" run session.toml --plugin-path .)
run=my_cast/runs/session
has $run/summary.json '"cast/my_cast"'
has $run/report.html cast/my_cast
ls $run/images/*.png >/dev/null
(cd my_cast && expect_exit 0 "$brace" run session.toml --set pipeline.cast=dvr --plugin-path . --out runs/dvr)
cmp -s $run/images/000023_left.png my_cast/runs/dvr/images/000023_left.png && fail "the edited stage changed no pixel"
sed -i 's/^void brace_cast/flaot wrong;\n&/' my_cast/my_cast.glsl
line=$(grep -n flaot my_cast/my_cast.glsl | cut -d: -f1)
(cd my_cast && expect_exit 2 "$brace" run session.toml --plugin-path . --out runs/wrong || exit 1)
has stderr "my_cast.glsl:$line"

echo "- native: new-stage, find_package, build, run, check-stage"
expect_exit 0 "$brace" new-stage cast their_cast --native --out native
expect_exit 0 "$cmake" -S native -B native/build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
  -DCMAKE_C_FLAGS="-Wall -Wextra -Wpedantic -Werror" -DCMAKE_CXX_COMPILER_LAUNCHER= -DCMAKE_C_COMPILER_LAUNCHER=
expect_exit 0 "$cmake" --build native/build
(cd native && expect_exit 0 "$brace" run session.toml --plugin-path build)
has native/runs/session/summary.json '"cast/their_cast"'
has native/runs/session/report.html cast/their_cast
ls native/runs/session/images/*.png >/dev/null

echo "- pkg-config"
if command -v pkg-config >/dev/null; then
  export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
  expect_exit 0 "$brace" new-stage predict my_predict --native
  # shellcheck disable=SC2046
  expect_exit 0 "$cc" -std=c11 -shared -fPIC -Wl,-z,defs $(pkg-config --cflags brace) my_predict/my_predict.c -lm \
    -o "$(pkg-config --variable=plugindir brace)/my_predict.so"
  expect_exit 0 "$brace" list stages
  has stdout predict/my_predict
  expect_exit 0 "$brace" check-stage predict/my_predict
  has stdout " 0 broken"
else
  echo "  left out: pkg-config is not installed"
fi

echo "- a broken plug-in on the path stops only who may need it"
mkdir broken
printf 'not a library' >broken/broken.so
expect_exit 0 env BRACE_PLUGIN_PATH=broken:my_cast "$brace" list plugins
has stdout broken.so
has stdout "found a file that is none"
has stdout cast/my_cast
expect_exit 0 env BRACE_PLUGIN_PATH=broken "$brace" run native/session.toml --set pipeline.cast=dvr \
  --set output.error=none --frames 2 --out runs/others
has stderr "plug-in left out: broken/broken.so"
expect_exit 3 env BRACE_PLUGIN_PATH=broken "$brace" run native/session.toml --out runs/needs-it
has stderr "broken/broken.so"
expect_exit 1 "$brace" check-stage broken/broken.so
has stdout "[FAIL] broken/broken.so: loads"
expect_exit 2 "$brace" new-stage schedule my_schedule
has stderr "--glsl cast"
echo "- examples/regression_test as a project of its own"
cp -r "$source/examples/regression_test" regression
expect_exit 0 "$cmake" -S regression -B regression/build -DCMAKE_PREFIX_PATH="$prefix"
expect_exit 0 "$(dirname "$cmake")/ctest" --test-dir regression/build
expect_exit 0 "$cmake" -S regression/gtest -B regression/gtest/build -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror" -DCMAKE_CXX_COMPILER_LAUNCHER=
expect_exit 0 "$cmake" --build regression/gtest/build
expect_exit 0 "$(dirname "$cmake")/ctest" --test-dir regression/gtest/build
has stdout "100% tests passed, 0 tests failed out of 1"
sed -i 's/cost = "model:gtx-1080"/&\ncost_scale = 40.0/' regression/session.toml
expect_exit 8 "$(dirname "$cmake")/ctest" --test-dir regression/build
has stdout "not_worse (Failed)"
expect_exit 8 "$(dirname "$cmake")/ctest" --test-dir regression/gtest/build --output-on-failure
has stdout "worse than the baseline:"
has stdout mtp_rotation_ms
echo done
