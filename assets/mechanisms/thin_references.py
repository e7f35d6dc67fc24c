#!/usr/bin/env python3
"""Thins tables of reference trajectories for the repository.

    thin_references.py FROM TO [--instants N] [--rename OLD=NEW]...

Reads FROM/*.csv as `sinew simulate` writes them (t, q:, u:, points, energies) and writes TO/*.csv. Values are written
with 14 significant digits: the tables are trusted to 12 in positions and 11 in rates, so what is cut off says nothing.
A table of more than LARGE columns keeps every second instant and, of its energies and points, none: they follow from
the coordinates. `--instants N` thins every table to at most N instants instead. `--rename` gives a coordinate the name
that its joint has in the mechanism's file.
"""
import argparse
import csv
import pathlib

DIGITS = 14
LARGE = 60  # columns: the drivers' tables have 94


def thinned(rows, instants, names):
    head, body = [kind + (of and ":" + names.get(of, of)) for kind, _, of in (x.partition(":") for x in rows[0])], rows[1:]
    keep = range(len(head))
    stride = 1
    if instants:
        stride = max(1, -(-(len(body) - 1) // (instants - 1)))
    elif len(head) > LARGE:
        stride = 2
        keep = [i for i, name in enumerate(head) if name == "t" or name[:2] in ("q:", "u:")]
    yield [head[i] for i in keep]
    for row in body[::stride]:
        yield [format(float(row[i]), f".{DIGITS}g") for i in keep]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--instants", type=int, default=0)
    parser.add_argument("--rename", action="append", default=[])
    options = parser.parse_args()
    names = dict(pair.split("=") for pair in options.rename)
    options.target.mkdir(parents=True, exist_ok=True)
    for path in sorted(options.source.glob("*.csv")):
        with open(path, newline="") as file:
            rows = list(csv.reader(file))
        with open(options.target / path.name, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(thinned(rows, options.instants, names))


if __name__ == "__main__":
    main()
