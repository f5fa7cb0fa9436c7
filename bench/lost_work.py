#!/usr/bin/env python3
"""What kill -9 costs a bake, by stage: a table of seconds of work that the next start has to do again.

  bench/lost_work.py [--build BUILD] [--least S] [--only STAGE,...] [--keep DIR] SCENE.glb [-- options of lambent bake]
  bench/lost_work.py --at S,S,... [--build BUILD] [--keep DIR] SCENE.glb [-- options of lambent bake]

Bakes the scene once without a break, and notes when each stage begins and when the cache's folder gets an entry. Then
bakes it again from an empty cache, kills it in every stage of at least S seconds (2), at the worst moment: just before
the end of the longest time without a new entry, told by seconds of all cores, and starts it again each time. Of the stage of
a kill

  lost = time of the new start until it is in that stage + time in that stage, of both runs - time in it without a break

in seconds of the clock and of all cores. The stages before are found in the cache; what reading them takes is part of
what is lost. The last run must leave the very bytes of the bake that nobody touched.

--at is for bakes that take hours: each start is killed after so many seconds, and lost is how long the next one takes
until it stands where that one stood, by stage and percent of it. Nothing is run to its end, no bytes are compared.

Linux; standard library only.
Run it on a machine that does nothing else. --keep DIR leaves bundle, reports and caches there.
"""
import argparse
import filecmp
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

LINE = re.compile(r"\r\x1b\[K([a-zA-Z][^\r\n%(]*?)(?: +(\d+\.\d) %| \()")
TICKS = os.sysconf("SC_CLK_TCK")
BEFORE_THE_END_S = 0.3  # of the longest time without an entry


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


class Run:
    """One start of the program: when stages began, and how it ended."""

    def __init__(self, command, report, entries_of=None):
        self.stages = []  # (name, s of the clock, s of all cores), as they begin
        self.at = ("", 0.0)  # stage, and percent where that is known
        self.entries = set()  # (file, s of the clock): a checkpoint may be written again and again
        self.clock = []  # (s of the clock, s of all cores)
        master, slave = pty.openpty()  # the program tells its stages to terminals only
        self.began, began = time.monotonic(), time.time()
        with open(report, "w") as out:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=slave)
        os.close(slave)
        self.said, self.over = "", False
        self.master = master
        self.entered = threading.Condition()
        self.reader = threading.Thread(target=self._read)
        self.reader.start()
        self.watch = None
        if entries_of:
            self.watch = threading.Thread(target=self._watch, args=(entries_of, began))
            self.watch.start()

    def _read(self):
        text = ""
        while True:
            try:
                got = os.read(self.master, 65536)
            except OSError:  # the other end is closed
                got = b""
            if not got:
                break
            text += got.decode("utf-8", "replace")
            self.said = (self.said + got.decode("utf-8", "replace"))[-2000:]
            for match in LINE.finditer(text):
                name = match.group(1).strip()
                self.at = (name, float(match.group(2) or 0.0))
                if self.stages and self.stages[-1][0] == name:
                    continue
                try:
                    cpu = cpu_seconds(self.process.pid)
                except (OSError, IndexError):
                    continue
                with self.entered:
                    self.stages.append((name, time.monotonic() - self.began, cpu))
                    self.entered.notify()
            text = text[text.rfind("\r"):] if "\r" in text else text  # the last line may come in two pieces
        os.close(self.master)
        with self.entered:
            self.over = True
            self.entered.notify()

    def _watch(self, folder, began):
        while self.reader.is_alive():
            try:
                self.clock.append((time.monotonic() - self.began, cpu_seconds(self.process.pid)))
            except (OSError, IndexError):
                break  # it has just ended
            for root, _, files in os.walk(folder):
                for name in files:
                    if name.endswith(".entry"):
                        try:
                            self.entries.add((name, os.stat(os.path.join(root, name)).st_mtime - began))
                        except OSError:
                            pass  # it is gone, having done its work
            time.sleep(0.2)

    def _end(self):
        _, status, usage = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        self.wall, self.cpu = time.monotonic() - self.began, usage.ru_utime + usage.ru_stime
        self.reader.join()
        if self.watch:
            self.watch.join()
        return self

    def finish(self):
        self._end()
        if self.process.returncode != 0:
            raise SystemExit(f"lost_work.py: the bake failed:\n{self.said}")
        return self

    def cores_at(self, seconds):
        """s of all cores by then."""
        return max((cpu for wall, cpu in self.clock if wall <= seconds), default=0.0)

    def kill_in(self, stage, after):
        """False where it came too late, or the stage never came."""
        with self.entered:
            self.entered.wait_for(lambda: self.over or any(s[0] == stage for s in self.stages))
            began = next((s[2] for s in self.stages if s[0] == stage), None)
        try:
            while began is not None and self.stages[-1][0] == stage and cpu_seconds(self.process.pid) < began + after:
                time.sleep(0.02)
        except (OSError, IndexError):
            pass  # it has just ended
        in_it = began is not None and self.stages[-1][0] == stage
        os.kill(self.process.pid, signal.SIGKILL)  # it is not waited for yet, so the number is still its own
        self._end()
        return in_it and self.process.returncode == -signal.SIGKILL

    def seconds_until(self, place):
        """Of the clock and of all cores, until it is in that stage and as far in it, or in a later one."""
        stage, percent = place
        while not self.over:
            reached = any(s[0] == stage for s in self.stages) and (self.at[0] != stage or self.at[1] >= percent)
            if reached:
                return time.monotonic() - self.began, cpu_seconds(self.process.pid)
            time.sleep(0.05)
        raise SystemExit(f"lost_work.py: the bake ended:\n{self.said}")

    def kill_at(self, seconds):
        time.sleep(max(0.0, self.began + seconds - time.monotonic()))
        at = self.at
        os.kill(self.process.pid, signal.SIGKILL)
        self._end()
        return at

    def spans(self):
        """name: (begin, end) of the clock and of all cores; of a name that comes twice, the last."""
        ends = [(s[1], s[2]) for s in self.stages[1:]] + [(self.wall, self.cpu)]
        return {name: ((wall, end[0]), (cpu, end[1])) for (name, wall, cpu), end in zip(self.stages, ends)}


def longest_gap(run, begin, end):
    """Without an entry, of those that reach into a stage: its length, and where it ends in the stage."""
    times = sorted(t for _, t in run.entries if t < end)
    marks = [0.0] + times + [end]
    best = (0.0, end)
    for first, second in zip(marks, marks[1:]):
        if second > begin and second - first > best[0]:
            best = (second - first, second)
    return best


def kill_after(start, moments):
    print("| killed after, s | in | lost, s | lost, s of all cores |\n|---|---|---|---|", flush=True)
    run = start("killed", "killed-cache")
    for after in moments:
        stage, percent = run.kill_at(after)
        run = start("killed", "killed-cache")
        lost = run.seconds_until((stage, percent))
        where = f"{stage}, {percent:.1f} %" if percent else stage
        print(f"| {after:.0f} | {where} | {lost[0]:.1f} | {lost[1]:.1f} |", flush=True)
    run.kill_at(0.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--least", type=float, default=2.0)
    parser.add_argument("--only", default="")
    parser.add_argument("--at", type=lambda text: [float(s) for s in text.split(",")])
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("scene")
    parser.add_argument("options", nargs="*")
    a = parser.parse_args()
    folder = a.keep or pathlib.Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)

    def start(name, cache, watched=False):
        command = [f"{a.build}/bin/lambent", "bake", a.scene, "-o", str(folder / f"{name}.lmb.glb"), "--cache",
                   str(folder / cache), "--json", *a.options]
        return Run(command, folder / f"{name}.json", folder / cache if watched else None)

    try:
        for name in ("whole", "killed"):
            shutil.rmtree(folder / f"{name}-cache", ignore_errors=True)
            (folder / f"{name}.lmb.glb").unlink(missing_ok=True)
        if a.at:
            return kill_after(start, a.at)
        whole = start("whole", "whole-cache", watched=True).finish()
        shutil.rmtree(folder / "whole-cache")
        spans = whole.spans()
        print(f"without a break {whole.wall:.1f} s, {whole.cpu:.1f} s of all cores\n", flush=True)
        chosen = []
        for name, ((begin, end), (cores, _)) in spans.items():
            if end - begin < a.least or (a.only and name not in a.only.split(",")):
                continue
            gap, at = longest_gap(whole, begin, end)
            chosen.append((name, gap, max(0.1, whole.cores_at(at - BEFORE_THE_END_S) - cores)))

        print("| stage | s | longest without an entry, s | killed after, s of all cores | lost, s "
              "| lost, s of all cores |")
        print("|---|---|---|---|---|---|", flush=True)
        last = None  # (stage, gap, killed after, time in it before the kill)

        def row(run):
            (stage, gap, after, before), of_run, of_whole = last, run.spans(), spans[last[0]]
            lost = [of_run[stage][k][1] + before[k] - (of_whole[k][1] - of_whole[k][0]) for k in (0, 1)]
            duration = of_whole[0][1] - of_whole[0][0]
            print(f"| {stage} | {duration:.1f} | {gap:.1f} | {after:.1f} | {lost[0]:.1f} | {lost[1]:.1f} |", flush=True)

        for stage, gap, after in chosen:
            run = start("killed", "killed-cache")
            in_it = run.kill_in(stage, after)
            if last:
                row(run)
            last = None
            if not in_it:
                print(f"| {stage} | | | was over sooner than before | | |", flush=True)
                continue
            wall, cpu = run.spans()[stage]
            last = (stage, gap, after, (wall[1] - wall[0], cpu[1] - cpu[0]))
        run = start("killed", "killed-cache").finish()
        if last:
            row(run)
        if not filecmp.cmp(folder / "whole.lmb.glb", folder / "killed.lmb.glb", shallow=False):
            raise SystemExit("lost_work.py: the bundle differs from that of the bake that nobody touched")
        print("\nthe same bytes", flush=True)
    finally:
        if not a.keep:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
