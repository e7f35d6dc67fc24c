"""The frame of c_bench.cpp from Python: 100 characters on their clips. python_bench.py ASSET [REPETITIONS]"""
import sys
import time

import numpy
import sinew

CHARACTERS, FRAMES = 100, 20


def main():
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    with sinew.Asset(sys.argv[1]) as asset, sinew.World(body_contact=False) as world:
        characters = [world.add_character(asset) for _ in range(CHARACTERS)]
        plays = sinew.Plays(characters, asset)
        begin = 0.01 * numpy.arange(CHARACTERS)

        def frame(k):
            plays.time[:] = begin + k / 60
            plays()
            if k == 0:
                for character in characters:
                    character.reset()
            world.step(1 / 60)

        frame(0)
        least = float("inf")
        for n in range(repetitions):
            start = time.perf_counter_ns()
            for k in range(n * FRAMES + 1, (n + 1) * FRAMES + 1):
                frame(k)
            least = min(least, (time.perf_counter_ns() - start) / FRAMES)
        print(f"{'Python, frame of 100 characters':40} {least:12.1f} ns")


main()
