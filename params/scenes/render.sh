#!/bin/sh
# Grows and shapes the leaves of a scene and renders it with POV-Ray.
# Usage: render.sh VENATION SCENE.pov [OUT.png] [WIDTH-PERCENT]; needs povray, and ImageMagick for a scene of several frames or an OUT that is no PNG. `./run scene NAME` calls it.
#
# The scene's comments say what it is made of:
#   // grow  NAME PARAMS [OPTION…]     a venation, from a parameter file beside the scene
#   // shape NAME GROWN [OPTION…]      a bent leaf of it, with the same parameters; NAME.inc is what the scene includes
#   // size  WIDTH HEIGHT
#   // frames N                        frame_number runs from 0 to N - 1; the pictures are laid side by side
set -eu
venation=$1 scene=$2 name=$(basename "$2" .pov) percent=${4:-100}
if [ ! -f "$scene" ]; then
    echo "render.sh: no scene $name; there are $(cd "$(dirname "$scene")" && echo *.pov | sed 's/\.pov//g')" >&2
    exit 3
fi
out=${3:-out/scenes/$name.png}
here=$(cd "$(dirname "$scene")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$(dirname "$out")"

sed -n 's|^// grow  *||p' "$scene" >"$work/grow"
sed -n 's|^// shape  *||p' "$scene" >"$work/shape"
total=$(($(wc -l <"$work/grow") + $(wc -l <"$work/shape"))) done=0
while read -r leaf params options; do
    done=$((done + 1))
    echo "$name: $done/$total grows $leaf" >&2
    # shellcheck disable=SC2086 # options are words
    "$venation" grow "$here/$params" --name "$leaf" -o "$work" -q --maps none --set texture.exr=none --set export.svg=no --set export.veins_image=no $options
    printf '%s\n' "$here/$params" >"$work/$leaf.params"
done <"$work/grow"
while read -r leaf grown options; do
    done=$((done + 1))
    echo "$name: $done/$total shapes $leaf" >&2
    # shellcheck disable=SC2086
    "$venation" shape "$work/$grown.graphml" --params "$(cat "$work/$grown.params")" --name "$leaf" -o "$work" -q --formats pov --size 1024 $options
done <"$work/shape"

size=$(sed -n 's|^// size  *||p' "$scene")
width=$((${size% *} * percent / 100)) height=$((${size#* } * percent / 100))
frames=$(sed -n 's|^// frames  *||p' "$scene")
cp "$scene" "$here/common.inc" "$work/"
echo "$name: renders $width x $height" >&2
(
    cd "$work"
    if ! povray -D +A0.1 +Q9 "+W$width" "+H$height" ${frames:++KFI0 +KFF$((frames - 1))} "+I$name.pov" +Oimage.png >povray.log 2>&1; then
        tail -n 20 povray.log >&2
        exit 1
    fi
)
if [ -n "$frames" ]; then
    montage "$work"/image*.png -tile "$(((frames + 1) / 2))x" -geometry +4+4 "$work/all.png"
    mv "$work/all.png" "$work/image.png"
fi
case $out in
*.png) mv "$work/image.png" "$out" ;;
*) convert "$work/image.png" -strip -quality 88 "$out" ;;
esac
echo "$out" >&2
