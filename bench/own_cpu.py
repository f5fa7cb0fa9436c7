#!/usr/bin/env python3
"""How much of each frame of bench_streaming is the program's own work on the CPU, without what the GL driver does.

    perf record -k mono -e cpu-clock -F 5000 -o perf.data bench_streaming FOLDER --log frames.log
    perf script -i perf.data -F comm,tid,time,ip,sym,dso | bench/own_cpu.py frames.log

Counts the samples of the render thread whose code is the program's or of libraries that are not the driver. On a GPU that is
what is left of the CPU's part of a frame, beside the driver's; on llvmpipe all else is drawing. Prints median, 95 %, worst,
how many frames took 3 ms more than the median (half a frame of 6 ms), and what the functions took in the frames that took most.
"""
import bisect
import collections
import re
import statistics
import sys

DRIVER = re.compile(r"swrast|JIT|LLVM|libGL|libEGL|libgl|libgcc|kernel|unknown|perf-\d+|libc\.so|vdso|nvidia|\[")
LINE = re.compile(r"^\s*(?P<comm>.+?)\s+(?P<tid>\d+)\s+(?P<time>\d+\.\d+):\s+[0-9a-f]+\s+(?P<sym>.*?)\s+\((?P<dso>.*)\)\s*$")


def main() -> None:
    frames = [line.split() for line in open(sys.argv[1])]
    begins = [float(f[2]) for f in frames]
    first_tid = None
    found = [collections.Counter() for _ in frames]
    for line in sys.stdin:
        match = LINE.match(line)
        if not match:
            continue
        if first_tid is None:
            first_tid = match["tid"]  # the render thread starts all others
        time = float(match["time"])
        if match["tid"] != first_tid or DRIVER.search(match["dso"]):
            continue
        at = bisect.bisect_right(begins, time) - 1
        if at >= 0 and time < float(frames[at][3]):
            found[at][match["sym"]] += 1
    ms = 1e3 / 5000  # of a sample: perf's -F
    for flight in dict.fromkeys(f[0] for f in frames):
        of = [i for i, f in enumerate(frames) if f[0] == flight]
        own = [ms * sum(found[i].values()) for i in of]
        ordered = sorted(own)
        median = statistics.median(own)
        print(f"{flight}: own CPU median {median:.2f} ms, 95 % under {ordered[int(0.95 * (len(own) - 1))]:.2f} ms, "
              f"worst {ordered[-1]:.2f} ms, 3 ms over the median: {sum(o > median + 3 for o in own)} of {len(own)}")
        whole = collections.Counter()
        for i in of:
            whole.update(found[i])
        print("  mean ms a frame: " + ", ".join(f"{sym.split('(')[0][-48:]} {ms * n / len(of):.2f}"
                                               for sym, n in whole.most_common(14)))
        for o, i in sorted(zip(own, of), reverse=True)[:8]:
            print(f"  frame {frames[i][1]}: {o:.1f} ms: " +
                  ", ".join(f"{sym.split('(')[0][-48:]} {ms * n:.1f}" for sym, n in found[i].most_common(7)))


main()
