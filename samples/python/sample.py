#!/usr/bin/env python3
"""Sinew from Python: a walker is hit by a ball, and pushed a second later: the run of ../c/main.c, to the bit.
Usage: sample.py ASSET.sinew [FRAMES], with the built package (build/python) on PYTHONPATH."""
import sys

import sinew


def add_pose(value, model):
    """FNV-1a over rotation and translation of every joint."""
    for joint in model:
        for byte in bytes(joint[:7]):
            value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def run(path, frames):
    value = 0xCBF29CE484222325
    with sinew.Asset(path) as asset, sinew.World() as world:
        chest = asset.find_role(sinew.Role.CHEST)
        hero = world.add_character(asset)
        world.add_prop(mass=4, pose={"translation": (0, 3, 1.5)}, velocity=(1.2, -6, 2))
        for frame in range(frames):
            hero.play(asset, 0, frame / 60)
            if frame == 0:
                hero.reset()
            if frame == 60:
                hero.apply_impulse(chest, hero.model[chest][4:7], (0, 90, 0))
            world.step(1 / 60)
            value = add_pose(value, hero.model)
        report = hero.report
    where = "on" if report.on_animation else "off"
    print(f"{report.unknown_dofs} of {report.dofs} degrees of freedom unknown at the end, {where} the animation")
    print(f"pose hash {value:016x}")


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: sample.py ASSET.sinew [FRAMES]")
    try:
        run(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 180)
    except sinew.Error as error:
        sys.exit(f"python: {sys.argv[1]}: {error}")


main()
