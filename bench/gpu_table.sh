#!/usr/bin/env bash
# Every benchmark of this device, one file each, and demo replays at the headset's full resolution, in under ten
# minutes:
#   bench/gpu_table.sh [FOLDER] [BRACE] [VOLUME]
# FOLDER is runs/gpu_table by default, BRACE build/release/bin/brace, VOLUME the demo's own.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-runs/gpu_table}
brace=${2:-build/release/bin/brace}
volume=${3:-}
mkdir -p "$folder"

"$brace" doctor | tee "$folder/device.txt"
for name in raycast distort warp mab stereo integrators host costs replay schedule skip; do
  echo "== brace bench $name"
  options=()
  # replay: one core of the host, not what this table is about; stereo: whole it takes longer than the rest
  case $name in replay | stereo) options=(--quick) ;; esac
  if timeout 300 "$brace" bench "$name" "${options[@]}" >"$folder/$name.txt" 2>"$folder/$name.log"; then
    tail -n 3 "$folder/$name.txt"
  else
    echo "brace bench $name failed or took more than five minutes: $folder/$name.log" >&2
  fi
done

settings=(--set clock.cost=measured --set device.resolution_scale=1.0 --set output.error=none)
[ -n "$volume" ] && settings+=(--set "scene.volume=$volume")
"$brace" run examples/demo.toml "${settings[@]}" --frames 180 --out "$folder/demo" | tee "$folder/demo.txt"

# Pacing by the host's clock at the headset's own rate.
"$brace" run examples/demo.toml "${settings[@]}" --set clock.mode=wall --set clock.queue=single \
  --set output.images=none --frames 450 --out "$folder/wall" | tee "$folder/wall.txt"
