# For the scripts beside it, which set $build: percent PICTURE REFERENCE1 REFERENCE2 [SHRINK] -> relative RMS in percent, free
# of the references' noise; of means of SHRINK x SHRINK pixels. same_surface_percent: over the pixels that show one surface in
# all three; - where a picture has no depths. Figures of all pixels stand at two spaces in the JSON, those of sameSurface at
# four.
percent_at() { # spaces PICTURE REFERENCE1 REFERENCE2 [SHRINK]
  "$build"/bin/lambent compare "$2" "$3" --reference2 "$4" --shrink "${5-1}" --json |
    sed -n 's/^ \{'"$1"'\}"relativeRms": \([0-9.e+-]*\).*/\1/p' | awk '$1 != "" { found = sprintf("%.2f", 100 * $1) } END { printf found == "" ? "-" : found }'
}
percent() { percent_at 2 "$@"; }
same_surface_percent() { percent_at 4 "$@"; }
