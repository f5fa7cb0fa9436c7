#!/usr/bin/env bash
# Frames per second and what each frame does with 200 rigid groups, 20 of them moving: bench/many_bodies.sh [-b BUILD]
# [-f FRAMES] [-s WxH] [-c CAPTURES]. One light sample a group, a tenth of a second of animation from frame to frame, at
# most so many captures in each. An idle machine, please: times are medians of wall time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/release frames=40 size=640x360 captures=16
while getopts b:f:s:c: option; do
  case $option in
    b) build=$OPTARG ;;
    f) frames=$OPTARG ;;
    s) size=$OPTARG ;;
    c) captures=$OPTARG ;;
    *) sed -n 2,4p "$0" >&2; exit 2 ;;
  esac
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$build/bin/lambent" bake "$build/assets/field.glb" -o "$folder/field.lmb.glb" --quality draft --light-probes 1 >/dev/null
"$build/bin/lambent-demo" "$folder/field.lmb.glb" --light "$build/assets/sky.hdr" --camera main --size "$size" \
  --time 4 --step 0.1 --frames "$frames" --captures-per-frame "$captures" \
  --headless "$folder/field.png" --json >"$folder/report.json"
python3 - "$folder/report.json" <<'PYTHON'
import json, sys
report = json.load(open(sys.argv[1]))
frame, times = report["last_frame"], report["frame_ms"]
print(f"{report['renderer']}, {report['size'][0]} x {report['size'][1]}")
print(f"{times['frames_per_second']:.1f} frames/s; median {times['median']:.0f} ms, 95 % under {times['p95']:.0f} ms")
print("| pass | CPU ms | GPU ms | draw calls | dispatches |\n|---|---|---|---|---|")
for p in frame["passes"]:
    print(f"| {p['name']} | {p['cpu_ms']:.1f} | {p['gpu_ms'] or 0:.1f} | {p['draw_calls']} | {p['dispatches']} |")
print(", ".join(f"{key} {value}" for key, value in frame["counts"].items()))
PYTHON
