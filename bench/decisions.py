#!/usr/bin/env python3
"""Checks what plans leave out: bakes each scene as planned and with --effects all, and holds pictures and costs of both together.

    bench/decisions.py [-b BUILD] [-o DIR] [-q QUALITY] [-l LIGHT]... SCENE[@CAMERA]...

The picture may change by less than the error that the bake states. A row per scene says: what is left out in how many groups,
the change of the picture in the light where it is largest, the stated error, and seconds of processor time and bytes that were
saved. Times are the least of three bakes where these are short, and mean nothing below 0.1 s. Codes are kept to 0.1 %, so that
they do not hide the rest. Exits with 1 if a picture changes by more.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

LIGHTS = ["constant:1,1,1"]
CAMERA = "orbit:35,20,2.6,40"
# Codes as wide as those of a draft alone change pictures by a per cent.
CODES = ["--codes", "0.1%"]


def run(words: list) -> tuple[dict, float]:
    """Returns what a program says as JSON, and its processor time in seconds."""
    process = subprocess.Popen([str(w) for w in words], stdout=subprocess.PIPE)
    said = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"{' '.join(map(str, words))}: exit code {process.returncode}")
    return json.loads(said) if said.strip() else {}, usage.ru_utime + usage.ru_stime


def picture_error(report: dict) -> float:
    """Returns the error that a bake states, of its worst group: of pictures where it measured them, else of codes."""
    shown = [g["pictureError"]["all"] for g in report["groups"] if g["pictureError"]]
    return max(shown + [report["codingError"], report["glossyCodingError"]])


def left_out(plan: dict) -> str:
    counts = {}
    for group in plan["groups"]:
        for decision in group["decisions"]:
            if decision["decision"] == "leftOut" and decision["effect"] in ("shadows", "interreflection"):
                counts[decision["effect"]] = counts.get(decision["effect"], 0) + 1
    groups = len(plan["groups"])
    return ", ".join(f"{effect} in {n} of {groups}" for effect, n in counts.items()) or "nothing"


def check(lambent, demo, scene: str, camera: str, lights: list, quality: str, out: pathlib.Path) -> bool:
    name = pathlib.Path(scene).stem
    plan, _ = run([lambent, "plan", scene, "--quality", quality, *CODES, "--json"])
    bundles, reports, seconds = {}, {}, {}
    for effects in ("auto", "all"):
        bundles[effects] = out / f"{name}.{effects}.lmb.glb"
        times = []
        while len(times) < 3 and (not times or times[0] < 5.0):
            reports[effects], took = run([lambent, "bake", scene, "-o", bundles[effects], "--effects", effects, "--quality",
                                          quality, *CODES, "--threads", 2, "--cache", "off", "--force", "--json"])
            times.append(took)
        seconds[effects] = min(times)
    change = 0.0
    for i, light in enumerate(lights):
        pictures = []
        for effects, bundle in bundles.items():
            pictures.append(out / f"{name}.{effects}.{i}.exr")
            run([demo, bundle, "--light", light, "--camera", camera, "--size", "320x180", "--headless", pictures[-1], "--json"])
        compared, _ = run([lambent, "compare", *pictures, "--json"])
        change = max(change, compared["relativeRms"])
    stated = picture_error(reports["auto"])
    saved_s = seconds["all"] - seconds["auto"]
    saved_bytes = reports["all"]["fileBytes"] - reports["auto"]["fileBytes"]
    kept = change <= stated
    print(f"| {name} | {left_out(plan)} | {100 * change:.3f} | {100 * stated:.2f}{'' if kept else ' **missed**'} "
          f"| {saved_s:.2f} | {seconds['auto']:.2f} | {saved_bytes} |", flush=True)
    return kept


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-b", "--build", default="build/release")
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path("out/decisions"))
    parser.add_argument("-q", "--quality", default="draft")
    parser.add_argument("-l", "--light", action="append", default=[])
    parser.add_argument("scenes", nargs="+", metavar="SCENE[@CAMERA]")
    words = parser.parse_args()
    words.out.mkdir(parents=True, exist_ok=True)
    programs = pathlib.Path(words.build) / "bin"
    print("| scene | left out | picture changes, % | stated error, % | seconds saved | seconds in all "
          "| bytes saved |\n|---|---|---|---|---|---|---|")
    kept = True
    for word in words.scenes:
        scene, _, camera = word.partition("@")
        kept &= check(programs / "lambent", programs / "lambent-demo", scene, camera or CAMERA, LIGHTS + words.light,
                      words.quality, words.out)
    sys.exit(0 if kept else 1)


if __name__ == "__main__":
    main()
