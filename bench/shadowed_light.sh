#!/usr/bin/env bash
# What several light samples buy under a near light, against the path-traced reference:
#   bench/shadowed_light.sh [-o DIR] [-b BUILD] [-s SPP] [-n BOUNCES] [-p] [SCENE.glb]
# A sphere of light, 20 degrees in radius as seen from the middle of the scene (assets/knot.glb; one rigid
# group), stands at half the scene's diagonal over 0.1, 0.25, 0.5 and 0.8 from that middle, and for
# comparison at 0.001, as good as infinity. Bakes with 1, 4, 8, 16 and 32 light samples are compared with the
# mean of two references (free of their noise), whose light is cut to the same five bands at each point
# ("error": what light samples cause), and with two that have the whole light ("whole": truncation as well).
# Three cameras; the table has the root mean square of their errors. Prints markdown; writes DIR/shadowed_light.csv
# and DIR/near-light.svg. Direct light, unless -n gives bounces. -p: DIR/near-light.png too: 1 light sample, 32
# and the reference of five bands side by side at 0.8 (needs oiiotool).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/release out=out/shadowed_light spp=128 bounces=0 pictures=
usage() { sed -n 2,13p "$0" >&2; exit 2; }
while getopts "o:b:s:n:p" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    n) bounces=$OPTARG ;;
    p) pictures=yes ;;
    *) usage ;;
  esac
done
shift $((OPTIND - 1))
(($# <= 1)) || usage
scene=${1-$build/assets/knot.glb}
if [[ $pictures ]] && ! command -v oiiotool >/dev/null; then
  echo "shadowed_light.sh: -p needs oiiotool" >&2
  exit 2
fi
ratios=(0.001 0.1 0.25 0.5 0.8) counts=(1 4 8 16 32)
cameras=(orbit:10,30,2.3,40 orbit:100,20,2.3,40 orbit:310,55,2.3,40)
size=320x320
name=$(basename "${scene%.*}").b$bounces
mkdir -p "$out"

for count in "${counts[@]}"; do
  "$build"/bin/lambent bake "$scene" -o "$out/$name.$count.lmb.glb" --bounces "$bounces" --light-probes "$count" --force >/dev/null
done

# A light word: towards azimuth and elevation 40 of the middle of the one group, radiance such that a surface
# in the middle that faces it has E/pi = 1.
sphere_at() { # bundle, ratio
  python3 - "$1" "$2" <<'PYTHON'
import json, math, pathlib, struct, sys
data = pathlib.Path(sys.argv[1]).read_bytes()
document = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
groups = document["extensions"]["LAMBENT_radiance_transfer"]["groups"]
if len(groups) != 1 or any(groups[0]["restTranslation"]) or groups[0]["restRotation"] != [0, 0, 0, 1]:
    sys.exit("shadowed_light.sh: the scene should be one rigid group that stands where it is")
low, high = groups[0]["boundsMin"], groups[0]["boundsMax"]
distance = 0.5 * math.dist(low, high) / float(sys.argv[2])
sine, turn = math.sin(math.radians(20)), math.radians(40)
way = (math.sin(turn) * math.cos(turn), math.sin(turn), math.cos(turn) * math.cos(turn))
place = [0.5 * (a + b) + distance * w for a, b, w in zip(low, high, way)]
radius = sine * distance
if all(a - radius < p < b + radius for a, b, p in zip(low, high, place)):
    sys.exit("shadowed_light.sh: the light would stand within the scene, where it is shaded per pixel")
print("sphere:" + ",".join(f"{v:.6g}" for v in (*place, radius, 1 / sine**2)))
PYTHON
}
figure() { sed -n "s/^  \"$2\": \([0-9.e+-]*\).*/\1/p" "$1"; }

csv=$out/shadowed_light.csv
echo "scene,bounces,ratio,samples,error1,error2,error3,error,whole" > "$csv"
echo "| half-size / distance | light samples | error, three cameras | error | against whole light |"
echo "|---|---|---|---|---|"
for ratio in "${ratios[@]}"; do
  light=$(sphere_at "$out/$name.1.lmb.glb" "$ratio")
  for camera in "${!cameras[@]}"; do
    words=(--light "$light" --camera "${cameras[camera]}" --size $size)
    for seed in 1 2; do
      for limit in 5 ""; do
        picture=$out/$name.$ratio.$camera.${limit:-whole}.$seed.exr
        [[ -e $picture ]] ||
          "$build"/bin/lambent reference "$scene" "${words[@]}" ${limit:+--band-limit $limit} --bounces "$bounces" \
            --spp "$spp" --seed $seed -o "$picture" >/dev/null
      done
    done
    for count in "${counts[@]}"; do
      stem=$out/$name.$ratio.$camera.$count
      "$build"/bin/lambent-demo "$out/$name.$count.lmb.glb" "${words[@]}" --window off --local-radii 0 --headless "$stem.exr" >/dev/null
      for limit in 5 whole; do
        "$build"/bin/lambent compare "$stem.exr" "$out/$name.$ratio.$camera.$limit.1.exr" \
          --reference2 "$out/$name.$ratio.$camera.$limit.2.exr" --json > "$stem.$limit.json"
      done
    done
  done
  for count in "${counts[@]}"; do
    figures=()
    for limit in 5 whole; do
      for camera in "${!cameras[@]}"; do
        figures+=("$(figure "$out/$name.$ratio.$camera.$count.$limit.json" relativeRms)")
      done
    done
    awk -v scene="$(basename "$scene" .glb)" -v bounces="$bounces" -v ratio="$ratio" -v count="$count" -v csv="$csv" '{
      error = 100 * sqrt(($1^2 + $2^2 + $3^2) / 3); whole = 100 * sqrt(($4^2 + $5^2 + $6^2) / 3)
      printf "| %s | %d | %.2f, %.2f, %.2f %% | %.2f %% | %.1f %% |\n", ratio, count, 100 * $1, 100 * $2, 100 * $3, error, whole
      printf "%s,%s,%s,%d,%.4f,%.4f,%.4f,%.4f,%.4f\n", scene, bounces, ratio, count, 100 * $1, 100 * $2, 100 * $3, error, whole >> csv
    }' <<< "${figures[*]}"
  done
done
python3 bench/plot_shadowed_light.py "$csv" "$out/near-light.svg"

[[ $pictures ]] || exit 0
words=(--light "$(sphere_at "$out/$name.1.lmb.glb" 0.8)" --camera orbit:15,35,1.9,38 --size 440x360)
panels=()
for panel in 1 32 reference; do
  picture=$out/$name.panel.$panel.exr
  if [[ $panel != reference ]]; then
    "$build"/bin/lambent-demo "$out/$name.$panel.lmb.glb" "${words[@]}" --window off --local-radii 0 --headless "$picture" >/dev/null
  elif [[ ! -e $picture ]]; then
    "$build"/bin/lambent reference "$scene" "${words[@]}" --band-limit 5 --bounces "$bounces" --spp 1024 -o "$picture" >/dev/null
  fi
  # 0.3 times radiance, over grey
  panels+=("$picture" --mulc 0.3,0.3,0.3,1 --pattern constant:color=0.03,0.03,0.03,1 440x360 4 --over)
done
oiiotool "${panels[@]}" --mosaic 3x1 --ch R,G,B --colorconvert linear sRGB -d uint8 -o "$out/near-light.png"
