#!/usr/bin/env bash
# Errors of what bodies change around them, against the path-traced reference:
#   bench/neighborhood_errors.sh [-o DIR] [-b BUILD] [-s SPP] [-z SIZE] [-n BOUNCES] [-e EXTENT] [-a "BAKE OPTIONS"]
#                                [-g "GRIDS"] KIND LIGHT... -- CAMERA...
# KIND: a scene of bench/neighborhood_scene.py (ball, ring, hills, pair). LIGHT: NAME=WORD+WORD..., words of --light that shine
# together, and what the table calls them. Per light, camera and size of grid: the error with the grid, without
# (--neighborhoods off: bodies meet in captures alone), bytes of the grid in the file, and seconds that the whole bake and
# the grid alone took. Light, and where the body is glossy its kernel at the first hit, are cut to five bands, which is
# what a perfect renderer of order 5 would show. Free of the reference's noise by two seeds (lambent compare
# --reference2). BOUNCES 3 if not said, no window. EXTENT XxYxZ: metres that the grid covers instead of what the bake finds.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build=$here/build/release out=$here/out/neighborhood_errors spp=256 size=256x192 bounces=3 options=() extent=()
grids="16x16x4 32x32x8 64x64x8 64x64x16"
usage() { sed -n 2,11p "$0" >&2; exit 2; }
while getopts "o:b:s:z:n:e:a:g:" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    z) size=$OPTARG ;;
    n) bounces=$OPTARG ;;
    e) extent=(--extent "$OPTARG") ;;
    a) read -ra options <<< "$OPTARG" ;;
    g) grids=$OPTARG ;;
    *) usage ;;
  esac
done
shift $((OPTIND - 1))
(($# >= 3)) || usage
kind=$1; shift
lights=()
while (($# > 0)) && [[ $1 != -- ]]; do lights+=("$1"); shift; done
[[ ${1-} == -- ]] && shift
cameras=("$@")
bands=5
[[ $kind == ring ]] && bands=5,5
mkdir -p "$out"

source "$here/bench/percent.sh"

figures() { # BUNDLE REPORT -> points, kB of the grid, seconds of the grid and of the whole bake, between bars
  python3 - "$@" <<'PYTHON'
import json, pathlib, struct, sys
data = pathlib.Path(sys.argv[1]).read_bytes()
report = json.loads(pathlib.Path(sys.argv[2]).read_text())
document = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
bundle = document["extensions"]["LAMBENT_radiance_transfer"]

def length(payload):
    return document["bufferViews"][bundle["payloads"][payload]["bufferView"]]["byteLength"]

cells = [cell for group in bundle["groups"] for cell in group["cells"] if cell["kind"] == "neighborhood"]
size = sum(length(part[key]) for cell in cells for part in cell["transfers"] for key in ("codebook", "clusterIds") if key in part)
size += sum(length(plane["payload"]) for cell in cells for part in cell["transfers"] for plane in part["planes"])
stages = report["stages"]
grid = sum(stage["seconds"] for stage in stages if "neighborhood" in stage["stage"])
points = ", ".join(" x ".join(str(n) for n in one["size"]) for one in report["neighborhoods"])
print("| %s | %.0f | %.0f | %.0f |" % (points, size / 1000, grid, sum(stage["seconds"] for stage in stages)), end=" ")
PYTHON
}

header="| points (x, y, z) | kB | s, grid | s, bake |" rule="|---|---|---|---|"
for light in "${lights[@]}"; do
  for camera in "${cameras[@]}"; do
    header+=" ${light%%=*}, $camera: on % | off % |" rule+="---|---|"
  done
done
echo "$header"
echo "$rule"
for grid in $grids; do
  name=$kind.$grid
  python3 "$here/bench/neighborhood_scene.py" "$kind" "$out/$name.glb" --grid "$grid" "${extent[@]}"
  "$build"/bin/lambent bake "$out/$name.glb" -o "$out/$name.lmb.glb" --bounces "$bounces" "${options[@]}" --force --json \
    > "$out/$name.json"
  figures "$out/$name.lmb.glb" "$out/$name.json"
  for light in "${lights[@]}"; do
    words=(--size "$size")
    IFS=+ read -ra together <<< "${light#*=}"
    for one in "${together[@]}"; do words+=(--light "$one"); done
    for camera in "${cameras[@]}"; do
      stem="$out/$kind.b$bounces.${light%%=*}.$camera.$size.$spp"
      for seed in 1 2; do
        [[ -e $stem.$seed.exr ]] ||
          "$build"/bin/lambent reference "$out/$name.glb" "${words[@]}" --camera "$camera" --band-limit $bands \
            --bounces "$bounces" --spp "$spp" --seed $seed -o "$stem.$seed.exr" >/dev/null
      done
      for carrier in on off; do
        "$build"/bin/lambent-demo "$out/$name.lmb.glb" "${words[@]}" --camera "$camera" --window off --residual off \
          --neighborhoods $carrier --headless "$stem.$grid.$carrier.exr" >/dev/null
        printf '%s | ' "$(percent "$stem.$grid.$carrier.exr" "$stem.1.exr" "$stem.2.exr")"
      done
    done
  done
  echo
done
