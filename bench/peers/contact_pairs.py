#!/usr/bin/env python3
"""The time of a contact search for two bodies, in pliant and in coal, at the same random poses.

usage: contact_pairs.py FOLDER --program build/release/bench/pair_bench [--rounds 3]

Writes pair_peers.csv to FOLDER. Both programs run in alternation; the least times are written. The column max_difference_m
is the largest difference between the gap in pliant and the gap in coal.
"""
import argparse
import csv
import importlib.metadata
import subprocess
import sys
from pathlib import Path

import native_peer


def rows_of(text):
    return [line.split(",") for line in text.split("\n") if line]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", type=Path, required=True, help="path of pair_bench")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    native_peer.build(folder / "native", sys.prefix)
    peer = folder / "native" / "coal_peer"
    if not peer.exists():
        raise SystemExit("coal_peer was not built: coal or Eigen was not found")
    times, differences = {}, {}
    for _ in range(options.rounds):
        subprocess.run([options.program.resolve(), folder], check=True, stdout=subprocess.DEVNULL)
        found = subprocess.run([peer, folder / "pair_poses.csv"], check=True, capture_output=True, text=True).stdout
        for engine, rows in (("pliant", rows_of((folder / "pair_bench.csv").read_text())[1:]), ("coal", rows_of(found))):
            for pair, band, *numbers in rows:
                cold, warm, *difference = map(float, numbers)
                least = times.get((pair, band, engine), (cold, warm))
                times[pair, band, engine] = min(least[0], cold), min(least[1], warm)
                if difference:
                    differences[pair, band] = difference[0]
    with open(folder / "pair_peers.csv", "w", newline="") as file:
        file.write(f"# coal {importlib.metadata.version('coal')}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow("pair,gaps,pliant_cold_ns,pliant_warm_ns,coal_cold_ns,coal_warm_ns,max_difference_m".split(","))
        for (pair, band), difference in differences.items():
            numbers = [f"{x:.0f}" for engine in ("pliant", "coal") for x in times[pair, band, engine]]
            table.writerow([pair, band, *numbers, f"{difference:.1e}"])
            print(pair, band, *numbers, f"{difference:.1e}")


if __name__ == "__main__":
    main()
