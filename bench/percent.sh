# For the scripts beside it, which set $build: percent PICTURE REFERENCE1 REFERENCE2 -> relative RMS in percent, free of the
# references' noise.
percent() {
  "$build"/bin/lambent compare "$1" "$2" --reference2 "$3" --json |
    sed -n 's/.*"relativeRms": \([0-9.e+-]*\).*/\1/p' | awk '{ printf "%.2f", 100 * $1 }'
}
