#!/usr/bin/env bash
# What a change costs with a cache: bench/incremental.sh [-b BUILD] [-q QUALITY] [-c] [MODEL.glb]. Bakes ten movable groups
# (incremental_scenes.py), then again with nothing, one albedo, one node, one group changed, one group carried elsewhere;
# each from the cache of the first bake, and says seconds (wall, and of all cores), rays traced and bytes. -c compares every
# bundle with one that was baked without a cache. Neighborhoods are left out: what a body changes around it hangs on
# where the others are.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/release quality=standard compare=
while getopts b:q:c option; do
  case $option in
    b) build=$OPTARG ;;
    q) quality=$OPTARG ;;
    c) compare=yes ;;
    *) sed -n 2,6p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
model=${1:-../shared/data/models/spot.glb}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PYTHONDONTWRITEBYTECODE=1 python3 bench/incremental_scenes.py "$model" "$folder"

bake() {  # SCENE OUT CACHE REPORT
  rm -f "$folder/$2"
  TIMEFORMAT='%R %U %S'
  { time "$build/bin/lambent" bake "$folder/$1.glb" -o "$folder/$2" --quality "$quality" --effects diffuse,glossy \
      --cache "$3" --json >"$4" 2>/dev/null; } 2>"$4.time"
}

row() {  # NAME REPORT
  python3 - "$1" "$2" <<'PYTHON'
import json, sys
name, path = sys.argv[1:]
r = json.load(open(path))
wall, user, system = (float(t) for t in open(path + ".time").read().split()[-3:])
work = [e["work"] for g in r["groups"] for e in g["effects"]]
traced, kept = r["rays"] + r["refinement"]["rays"], r["raysKept"] + r["refinement"]["raysKept"]
print(f"| {name} | {wall:.1f} | {user + system:.1f} | {traced / 1e6:.1f} | {kept / 1e6:.1f} | "
      f"{work.count('baked')} / {work.count('re-gathered')} / {work.count('found')} | "
      f"{r['cache']['bytesRead'] / 1e6:.0f} / {r['cache']['bytesWritten'] / 1e6:.0f} |")
PYTHON
}

echo "| change | s | s of all cores | Mrays traced | Mrays kept | groups baked / re-gathered / found | MB read / written |"
echo "|---|---|---|---|---|---|---|"
bake full plain.lmb.glb off "$folder/report.json"
row "all, no cache" "$folder/report.json"
bake full full.lmb.glb "$folder/cache" "$folder/report.json"
row "all, empty cache" "$folder/report.json"
cmp "$folder/plain.lmb.glb" "$folder/full.lmb.glb"
for change in full carried albedo node group; do
  rm -rf "$folder/copy"
  cp -a "$folder/cache" "$folder/copy"
  bake "$change" again.lmb.glb "$folder/copy" "$folder/report.json"
  case $change in
    full) name="nothing" ;;
    carried) name="one group carried elsewhere" ;;
    albedo) name="one albedo" ;;
    node) name="one node moved" ;;
    group) name="one of ten groups" ;;
  esac
  row "$name" "$folder/report.json"
  [[ $compare ]] || continue
  bake "$change" plain.lmb.glb off "$folder/plain.json"
  cmp "$folder/plain.lmb.glb" "$folder/again.lmb.glb"
done
