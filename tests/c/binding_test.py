"""The Python package: what cannot be meant, through every function that sinew_abi.json describes and through the classes.

    PYTHONPATH=build/python python3 binding_test.py build/sample.sinew runtime/sinew/c/sinew_abi.json"""
import ctypes
import gc
import json
import math
import sys
import unittest

import sinew
from sinew import _abi, lib

ASSET = ABI = None
# Pointers that may be null, as sinew.h says; all others are refused.
NULLABLE = {("sinew_world_create", "settings"), ("sinew_world_add_character", "settings"), ("sinew_world_add_prop", "settings"),
            ("sinew_world_report_contacts", "settings"), ("sinew_world_set_jobs", "context"), ("sinew_prop_get_state", "pose"),
            ("sinew_prop_get_state", "velocity"), ("sinew_loop_get_state", "gap"), ("sinew_loop_get_state", "force"),
            ("sinew_character_add_behaviour", "settings"), ("sinew_world_take_contacts", "dropped")}


class Everything:
    """A world with one of each."""

    def __init__(self):
        self.asset = sinew.Asset(ASSET)
        self.world = sinew.World()
        self.character = self.world.add_character(self.asset, root=sinew.RootDrive.GROUNDED)
        self.character.add_behaviour()
        self.prop = self.world.add_prop(pose={"translation": (3, 0, 1)})
        self.loop = self.world.add_loop(
            kind=sinew.LoopKind.ROPE, length=5, a={"kind": sinew.AnchorKind.PROP, "handle": self.prop})
        self.world.report_contacts()
        self.handles = {"sinew_asset": self.asset.handle, "sinew_world": self.world.handle,
                        "sinew_character": self.character.handle, "sinew_prop": self.prop.handle, "sinew_loop": self.loop.handle}


def meant(parameter, scene, memory):
    """An argument that a call of the type would not be refused for at once."""
    kind = parameter["type"]
    if kind in scene.handles:
        return scene.handles[kind]
    if kind == "const char*":
        return b"head"
    if kind.endswith("*"):
        base = kind.removeprefix("const ").rstrip("*")
        if base in ABI["structs"] and ABI["structs"][base]["fields"][0]["name"] == "size":
            ctypes.c_uint32.from_buffer(memory).value = ABI["structs"][base]["size"]
        return ctypes.addressof(memory)
    if kind in ABI["callbacks"]:
        return ctypes.cast(None, getattr(_abi, "".join(p.capitalize() for p in kind.split("_")[1:])))
    return 1


def functions(wanted):
    """Functions with a parameter of that kind: name, parameters, which."""
    for name, function in ABI["functions"].items():
        for n, parameter in enumerate(function["parameters"]):
            if wanted(parameter["type"]):
                yield name, function["parameters"], n


def destroys(name):
    return name.endswith("_destroy")


class BadInput(unittest.TestCase):
    def setUp(self):
        self.scene = Everything()
        self.buffers = []

    def call(self, name, parameters, bad):
        """Calls with arguments that can be meant but for those given."""
        arguments = []
        for parameter in parameters:
            memory = (ctypes.c_char * 65536)()
            self.buffers.append(memory)
            arguments.append(bad[parameter["name"]] if parameter["name"] in bad else meant(parameter, self.scene, memory))
        return getattr(lib, name)(*arguments)

    def test_every_function_refuses_handles_that_name_nothing(self):
        dead = Everything()
        stale = dict(dead.handles)
        dead.world.close()
        dead.asset.close()
        checked = 0
        for name, parameters, n in functions(lambda kind: kind in ABI["handles"]):
            kind, parameter = parameters[n]["type"], parameters[n]["name"]
            other = self.scene.handles["sinew_asset" if kind != "sinew_asset" else "sinew_world"]
            for handle in (0, stale[kind], other, 2**64 - 1, self.scene.handles[kind] ^ 1 << 30):
                status = self.call(name, parameters, {parameter: handle})
                self.assertEqual(status, sinew.Status.BAD_HANDLE, f"{name}({parameter}={handle:#x})")
                self.assertTrue(lib.sinew_last_reason())
                checked += 1
        self.assertGreater(checked, 300)

    def test_every_function_refuses_nulls(self):
        checked = 0
        for name, parameters, n in functions(lambda kind: kind.endswith("*")):
            parameter = parameters[n]["name"]
            if (name, parameter) in NULLABLE or parameter.endswith("context"):
                continue
            status = self.call(name, parameters, {parameter: None})
            if (name, parameter) == ("sinew_world_save", "out"):
                self.assertEqual(status, sinew.Status.INVALID_ARGUMENT, name)  # with a capacity that is not 0
            self.assertNotEqual(status, sinew.Status.OK, f"{name}({parameter}=NULL)")
            self.assertNotEqual(status, sinew.Status.BAD_HANDLE, f"{name}({parameter}=NULL)")
            checked += 1
        self.assertGreater(checked, 60)

    def test_every_struct_refuses_sizes_that_are_none(self):
        checked = 0
        for name, parameters, n in functions(lambda kind: kind.endswith("*")):
            base = parameters[n]["type"].removeprefix("const ").rstrip("*")
            if base not in ABI["structs"] or ABI["structs"][base]["fields"][0]["name"] != "size":
                continue
            if name == "sinew_asset_get_muscle":
                continue  # the figure has none to ask for
            for size, wanted in ((0, sinew.Status.INVALID_ARGUMENT), (ABI["structs"][base]["size"] + 8, sinew.Status.BAD_VERSION),
                                 (2**32 - 1, sinew.Status.BAD_VERSION)):
                memory = (ctypes.c_char * 65536)()
                ctypes.c_uint32.from_buffer(memory).value = size
                status = self.call(name, parameters, {parameters[n]["name"]: ctypes.addressof(memory)})
                self.assertEqual(status, wanted, f"{name}: size {size}")
                checked += 1
        self.assertGreater(checked, 60)

    def test_every_number_may_be_nan(self):
        """No crash, and the figure stands where it stood."""
        before = self.scene.character.local[0].tolist()
        for name, parameters, n in functions(lambda kind: kind in ("float", "double")):
            status = self.call(name, parameters, {parameters[n]["name"]: math.nan})
            self.assertNotEqual(status, sinew.Status.OK, f"{name}({parameters[n]['name']}=NaN)")
        self.assertEqual(self.scene.character.local[0].tolist(), before)

    def test_double_destroy(self):
        handle = self.scene.world.handle
        self.scene.world.close()
        self.scene.world.close()
        self.assertEqual(lib.sinew_world_destroy(handle), sinew.Status.BAD_HANDLE)


class Classes(unittest.TestCase):
    def test_errors_have_status_and_reason(self):
        with self.assertRaises(sinew.Error) as raised:
            sinew.Asset("/nowhere")
        self.assertEqual(raised.exception.status, sinew.Status.IO)
        with self.assertRaisesRegex(sinew.Error, "gravity"):
            sinew.World(gravity=(0, 0, math.nan))
        with self.assertRaisesRegex(TypeError, "no field gravitation"):
            sinew.World(gravitation=1)
        with self.assertRaises(TypeError):
            sinew.World(gravity=(0, 0))

    def test_what_is_closed_is_refused(self):
        scene = Everything()
        with scene.world:
            scene.world.step(1 / 60)
        with self.assertRaisesRegex(sinew.Error, "BAD_HANDLE"):
            scene.world.step(1 / 60)
        with self.assertRaisesRegex(sinew.Error, "BAD_HANDLE"):
            scene.character.reset()

    def test_views_are_no_copies_and_outlive_close(self):
        scene = Everything()
        view = scene.character.local
        scene.character.play(scene.asset, 0, 0.3)
        scene.character.reset()
        self.assertEqual(view.tolist(), scene.character.local.tolist())
        now = view.tolist()
        scene.world.close()
        gc.collect()
        self.assertEqual(view.tolist(), now)

    def test_jets_of_the_wrong_number_are_refused(self):
        scene = Everything()
        jets = scene.asset.sample(0, 0.5)
        scene.character.set_target(jets)
        with self.assertRaisesRegex(sinew.Error, "per joint"):
            scene.character.set_target(jets[:-1])
        jets["velocity"][2] = math.nan
        with self.assertRaises(sinew.Error) as raised:
            scene.character.set_target(jets)
        self.assertEqual((raised.exception.status, raised.exception.index), (sinew.Status.NOT_FINITE, 2))

    def test_callbacks_snapshots_and_recordings(self):
        scene = Everything()
        lines = []
        scene.world.draw(line=lambda a, b, colour: lines.append((a, b, colour)))
        self.assertGreater(len(lines), 10)
        state = scene.world.save()
        scene.world.record()
        for frame in range(5):
            scene.character.play(scene.asset, 0, frame / 60)
            scene.world.step(1 / 60)
        recording = scene.world.recording
        scene.world.record(False)
        end = scene.world.save()
        scene.world.restore(state)
        self.assertNotEqual(state, end)
        report = scene.world.replay(recording)
        self.assertEqual((report.steps, report.same), (5, 1))
        self.assertEqual(scene.world.save(), end)
        with self.assertRaises(sinew.Error):
            scene.world.restore(state[:-1])

    def test_casts_meet_what_is_there(self):
        scene = Everything()
        hits = scene.world.cast((3, 0, 3), (0, 0, -4), most=2)
        self.assertEqual([hit.body.kind for hit in hits], [sinew.BodyKind.PROP, sinew.BodyKind.GROUND])
        self.assertEqual(len(scene.world.overlap((3, 0, 1), 0.2)), 1)

    def test_many_characters_in_one_call(self):
        scene = Everything()
        others = [scene.world.add_character(scene.asset) for _ in range(3)]
        plays = sinew.Plays(others, scene.asset)
        plays.time[:] = [0.1, 0.2, 0.3]
        plays()
        for other in others:
            other.reset()
        places = [other.local[1].tolist() for other in others]
        for n, other in enumerate(others):
            other.play(scene.asset, 0, 0.1 * (n + 1))
            other.reset()
            self.assertEqual(other.local[1].tolist(), places[n])


if __name__ == "__main__":
    ASSET = sys.argv[1]
    with open(sys.argv[2], encoding="utf-8") as file:
        ABI = json.load(file)
    unittest.main(argv=sys.argv[:1])
