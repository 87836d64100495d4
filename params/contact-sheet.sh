#!/bin/sh
# Grows every model of Table 1 (Runions et al. 2005) and lays the leaves out on one sheet.
# Usage: contact-sheet.sh VENATION PARAMS-FOLDER OUT.jpg [CELL-PIXELS]; needs ImageMagick. `./run sheet` calls it.
set -eu
venation=$1 params=$2 out=$3 cell=${4:-400}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# name, figure of the paper, label, extra setting
set -- \
    "kill-distance|9a–e|search: kill distance" "dart-density|9f–h|search: dart density" "slow-marginal|9i|slow marginal growth" \
    "ginkgo|10|ginkgo" "alchemilla|11|lady’s mantle" "sweetgum|12|sweetgum" \
    "toothed|13|toothed margin" "tertiary|13|tertiary veins" "orchid|14|orchid" \
    "reticulate|15|reticulate pattern" "cherry|16|Nankin cherry" "grass|14, 17|grass, a piece of the blade" \
    "poplar|18, 19|poplar" "developmental|20|developmental" "trillium|21|trillium petal"
count=$# number=0 cells=
for model in "$@"; do
    name=${model%%|*} rest=${model#*|}
    figure=${rest%%|*} label=${rest#*|}
    number=$((number + 1))
    echo "$number/$count $name" >&2
    # A blade of grass would be a thin plain strip: a piece of it is shown.
    size=$((cell * 2)) piece=
    [ "$name" = grass ] && size=$((cell * 10)) piece="-gravity center -crop $((cell * 17 / 10))x$((cell * 17 / 10))+0+0 +repage"
    "$venation" grow "$params/$name.ini" -o "$work/$name" --size "$size" --maps "base_color opacity" \
        --set texture.exr=none --set texture.margin=0.03 --set export.network=no --set export.svg=no --set export.veins_image=no
    convert "$work/$name/${name}_base_color.png" "$work/$name/${name}_opacity.png" -alpha off -compose CopyOpacity -composite -compose Over \
        $piece -resize "${cell}x${cell}" -background white -gravity center -extent "${cell}x${cell}" -flatten \
        -gravity south -splice "0x$((cell / 10))" -font DejaVu-Sans -pointsize $((cell / 22)) -fill '#333333' \
        -annotate "+0+$((cell / 40))" "$label (fig. $figure)" "$work/$name.png"
    cells="$cells $work/$name.png"
done
montage $cells -tile 5x -geometry +6+6 -background white "$work/sheet.png"
convert "$work/sheet.png" -strip -quality 88 "$out"
