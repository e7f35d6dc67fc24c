"""Clips of the mannequin, authored here: walking and running (gait.py), standing at ease (standing.py), getting up (get_up.py)."""
import gait
import get_up
import standing


def all_clips():
    return [gait.walk(), gait.run(), standing.stand(), *get_up.clips()]
