#!/bin/bash
# pictures.sh NAME...: makes pictures of docs/pictures anew, from a build folder (bin/, assets/); docs/pictures/README.md says
# what they show. Bundles and parts stay in the build folder. Needs ImageMagick (convert, montage) and OpenImageIO's oiiotool;
# sponza needs sponza.glb there, with a camera "ground" at (-8, 0.8, 0.5) along (0.993, 0.092, -0.076), 64.6 degrees high, and
# without the file's lamp.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
srgb="--colorconvert linear sRGB -d uint8"

gallery() {
  bin/lambent bake assets/gallery.glb -o gallery.lmb.glb
  local demo="bin/lambent-demo gallery.lmb.glb --camera main --size 1280x720"
  $demo --light constant:0.4,0.52,0.75 --light sun:-33,41,0.5,15000,13100,10800 --headless afternoon.png
  $demo --light assets/sky.hdr --rotate-light 200 --headless sky.png
  $demo --light assets/studio.hdr --rotate-light 60 --headless studio.png
  $demo --light constant:0.3,0.36,0.5 --light sun:33,20,0.6,12000,6300,2600 --headless evening.png
  for light in sky studio evening; do convert $light.png -resize 426x240! small-$light.png; done
  convert small-sky.png small-studio.png small-evening.png +append lower.png
  convert afternoon.png -resize 1278x719! lower.png -append -quality 90 -sampling-factor 4:4:4 gallery.jpg
}

sun() {
  bin/lambent bake assets/gallery.glb -o gallery.lmb.glb
  local view="--light constant:0.4,0.52,0.75 --light sun:-33,41,0.5,15000,13100,10800 --camera main --size 640x360"
  bin/lambent-demo gallery.lmb.glb $view --keys off --window auto --headless bands.exr
  bin/lambent-demo gallery.lmb.glb $view --headless keys.exr
  bin/lambent reference assets/gallery.glb $view --spp 400 -o reference.exr
  oiiotool bands.exr --ch R,G,B keys.exr --ch R,G,B reference.exr --ch R,G,B --mosaic 3x1 $srgb -o sun.png
  convert sun.png -quality 90 -sampling-factor 4:4:4 sun.jpg
}

sponza() {
  bin/lambent bake sponza.glb -o sponza.lmb.glb
  for turn in -75 15 105; do
    local view="--camera ground --size 480x270 --light sun:$turn,58,0.5,30000,26500,21500 --light constant:0.55,0.75,1.1"
    bin/lambent-demo sponza.lmb.glb $view --headless ours$turn.exr
    bin/lambent reference sponza.glb $view --spp 96 -o path$turn.exr
    bin/lambent reference sponza.glb $view --spp 96 --seed 5 -o again$turn.exr
    bin/lambent compare ours$turn.exr path$turn.exr --reference2 again$turn.exr
  done
  oiiotool ours-75.exr --ch R,G,B ours15.exr --ch R,G,B ours105.exr --ch R,G,B path-75.exr --ch R,G,B \
    path15.exr --ch R,G,B path105.exr --ch R,G,B --mosaic 3x2 --mulc 0.9 $srgb -o sponza.png
  convert sponza.png -quality 88 -sampling-factor 4:4:4 sponza.jpg
}

playroom() {
  bin/lambent bake assets/playroom.glb -o playroom.lmb.glb --rays 512
  local above=() below=()
  for time in 1 3 5; do
    local view="--light constant:0.2,0.25,0.36 --light sun:50,35,0.5,5000,4430,3700 --camera main --size 480x270 --time $time"
    bin/lambent-demo playroom.lmb.glb $view --headless demo-$time.exr
    bin/lambent reference assets/playroom.glb $view --spp 200 -o reference-$time.exr
    above+=(demo-$time.exr --ch R,G,B) below+=(reference-$time.exr --ch R,G,B)
  done
  oiiotool "${above[@]}" "${below[@]}" --mosaic 3x2 --mulc 1.2 $srgb -o playroom.png
}

metals() {
  bin/lambent bake assets/metals.glb -o metals.lmb.glb --rays 512 --bounces 3
  bin/lambent-demo metals.lmb.glb --light assets/studio.hdr --camera main --size 960x540 --headless metals.png
}

flight() {
  bin/lambent bake assets/flight.glb -o flight.lmb.glb --rays 512 --bounces 4
  bin/lambent-demo flight.lmb.glb --light sun:30,36,0.5,34000,30000,24500 --light constant:0.3,0.42,0.6 --camera main \
    --size 640x360 --exposure -0.8 --time 8.75 --step 1.25 --frames 8 --rotate-light 80 --headless flight-#.png
  # In the fourth frame the flyer's shadow falls into the cloud's and is too dark there.
  montage flight-[124567].png -resize 480x270 -tile 2x -geometry +2+2 flight.png
  convert flight.png -quality 88 flight.jpg
}

caustic() {
  python3 "$root/bench/neighborhood_scene.py" ring caustic.glb --grid 64x8x64 --extent 4.4x1.0x4.4
  bin/lambent bake caustic.glb -o caustic.lmb.glb --bounces 2
  local view="--light constant:0.3,0.34,0.4 --light sun:20,38,25,7,6.3,5.4 --camera orbit:0,45,0.85,24 --size 320x240"
  local demo="bin/lambent-demo caustic.lmb.glb $view --window off --specular-environment off"
  $demo --headless on.exr
  $demo --neighborhoods off --headless off.exr
  bin/lambent reference caustic.glb $view --band-limit 5,5 --bounces 2 --spp 256 -o reference.exr
  oiiotool on.exr --ch R,G,B reference.exr --ch R,G,B off.exr --ch R,G,B --mosaic 3x1 --mulc 0.6 $srgb -o caustic.png
}

ring() {
  bin/lambent bake assets/ring.glb -o ring.lmb.glb
  for turn in 0 90 180 270; do
    local view="--light constant:0.25,0.29,0.34 --light sun:20,38,12,26,24,21 --camera main --size 320x240 --rotate-light $turn"
    bin/lambent-demo ring.lmb.glb $view --keys off --window off --specular-environment off --exposure 0 \
      --headless demo-$turn.png
    bin/lambent reference assets/ring.glb $view --band-limit 5,5 --spp 160 -o reference.exr --png reference-$turn.png
  done
  montage demo-{0,90,180,270}.png reference-{0,90,180,270}.png -tile 4x2 -geometry +0+0 ring.png
}

blender() {
  LAMBENT_PICTURES=$PWD "$root/tests/baker/blender/run_blender.sh" "$PWD/bin/lambent" "$(bin/lambent --version | grep -o '[0-9][0-9.]*')" \
    "$root/tests/baker/blender/window_test.py" --window
  convert baking.png -crop 1057x560+0+28 +repage -resize 900x -quality 88 blender.jpg
}

accuracy() {
  chromium --headless --no-sandbox --hide-scrollbars --window-size=1280,1500 --virtual-time-budget=4000 \
    --screenshot=accuracy.png "$root/docs/accuracy/room/index.html"
}

tour() {
  xvfb-run -a -s "-screen 0 1280x800x24" "$root/scripts/editor-tour.sh" "$root/docs/pictures"
}

# The site's live pictures as they begin, and the viewer; after npm ci in web/.
live() {
  node "$root/web/site/make.js" --programs bin --assets assets --output site --scenes hello,gallery
  node "$root/web/bench/pictures.js" site "$root/docs/pictures"
}

for name in "$@"; do
  case $name in
    gallery | sun | sponza | playroom | metals | flight | caustic | ring | blender | accuracy | tour | live) $name ;;
    *) echo "pictures.sh: $name is none of its pictures" >&2; exit 2 ;;
  esac
done
