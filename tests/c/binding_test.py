"""The Python package: what cannot be meant, through every function that sinew_abi.json describes and through the classes.

    PYTHONPATH=build/python python3 binding_test.py build/sample.sinew build/sample.sgraph runtime/sinew/c/sinew_abi.json"""
import ctypes
import gc
import json
import math
import sys
import threading
import unittest

import sinew
from sinew import _abi, lib

ASSET = GRAPH = ABI = None
# Pointers that may be null, as sinew.h says; all others are refused.
NULLABLE = {("sinew_world_create", "settings"), ("sinew_world_add_character", "settings"), ("sinew_world_add_prop", "settings"),
            ("sinew_world_report_contacts", "settings"), ("sinew_world_set_jobs", "context"), ("sinew_prop_get_state", "pose"),
            ("sinew_prop_get_state", "velocity"), ("sinew_loop_get_state", "gap"), ("sinew_loop_get_state", "force"),
            ("sinew_character_add_behaviour", "settings"), ("sinew_world_take_contacts", "dropped"),
            ("sinew_character_add_graph", "settings"), ("sinew_character_get_graph_events", "lost"),
            ("sinew_character_add_wind", "settings"), ("sinew_character_add_buoyancy", "settings"),
            ("sinew_character_add_force_field", "settings"), ("sinew_character_add_joint_spring", "settings"),
            ("sinew_prop_add_wind", "settings"), ("sinew_prop_add_buoyancy", "settings"),
            ("sinew_prop_add_force_field", "settings"), ("sinew_world_add_strand", "settings"),
            ("sinew_asset_get_socket", "offset"), ("sinew_sensor_update", "left_out"), ("sinew_crowd_create", "settings"), ("sinew_crowd_create", "world"), ("sinew_crowd_create", "character")}


class Everything:
    """A world with one of each."""

    def __init__(self):
        self.asset = sinew.Asset(ASSET)
        self.world = sinew.World()
        self.character = self.world.add_character(self.asset, root=sinew.RootDrive.GROUNDED)
        self.character.add_behaviour()
        self.graph = sinew.Graph(GRAPH, self.asset)
        self.character.add_graph(self.graph)
        self.prop = self.world.add_prop(pose={"translation": (3, 0, 1)})
        self.loop = self.world.add_loop(
            kind=sinew.LoopKind.ROPE, length=5, a={"kind": sinew.AnchorKind.PROP, "handle": self.prop})
        self.street = sinew.Crowd(self.asset, capacity=4, places=1)
        self.street.play(0)
        self.particles = self.world.add_strand(particles=3, frame={"pose": {"translation": (5, 0, 2)}})
        self.effect = self.prop.add_wind(velocity=(1, 0, 0))
        self.sensor = self.world.add_sensor((3, 0, 1), 0.2)
        self.world.report_contacts()
        self.handles = {"sinew_asset": self.asset.handle, "sinew_world": self.world.handle,
                        "sinew_character": self.character.handle, "sinew_prop": self.prop.handle, "sinew_loop": self.loop.handle,
                        "sinew_graph": self.graph.handle, "sinew_effect": self.effect.handle,
                        "sinew_particles": self.particles.handle, "sinew_sensor": self.sensor.handle}


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
            argument = meant(parameter, self.scene, memory)
            if parameter["type"] == "sinew_world" and name.startswith("sinew_crowd_"):
                argument = self.scene.street.handle
            arguments.append(bad.get(parameter["name"], argument))
        return getattr(lib, name)(*arguments)

    def test_every_function_refuses_handles_that_name_nothing(self):
        dead = Everything()
        stale = dict(dead.handles)
        dead.world.close()
        dead.graph.close()
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

    def test_calls_from_a_second_thread_are_refused_while_one_runs(self):
        refused = []

        def line(*_):
            if refused:
                return

            def step():
                try:
                    self.scene.world.step(1 / 60)
                except sinew.Error as error:
                    refused.append(error.status)

            other = threading.Thread(target=step)
            other.start()
            other.join()

        before = self.scene.character.local[0].tolist()
        self.scene.world.draw(line=line)
        self.assertEqual(refused, [sinew.Status.BUSY])
        self.assertEqual(self.scene.character.local[0].tolist(), before)
        self.scene.world.step(1 / 60)

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
        self.assertLess(scene.character.physics.tilt, 0.5)
        self.assertAlmostEqual(scene.character.physics.height, 1, delta=0.2)
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

    def test_sensors_tell_who_comes_and_goes(self):
        scene = Everything()
        self.assertEqual([(e.phase, e.body.kind) for e in scene.sensor.update()],
                         [(sinew.ContactPhase.BEGIN, sinew.BodyKind.PROP)])
        self.assertEqual(len(scene.sensor.bodies), 1)
        scene.sensor.move((3, 0, 5), 0.2)
        self.assertEqual([e.phase for e in scene.sensor.update()], [sinew.ContactPhase.END])
        self.assertEqual((scene.sensor.bodies, scene.sensor.left_out), ([], 0))
        with self.assertRaisesRegex(sinew.Error, "radius"):
            scene.sensor.move((0, 0, 0), -1)

    def test_who_is_kept_apart_passes_through(self):
        with sinew.World() as world:
            for height, layers, meets in ((0.1, 2, 2**32 - 1), (0.5, 4, 2**32 - 1), (0.9, 8, 0)):
                world.add_prop(pose={"translation": (0, 0, height)}, layers=layers, meets=meets)
            world.keep_apart((sinew.BodyKind.PROP, 0), (sinew.BodyKind.PROP, 1))
            for _ in range(90):
                world.step(1 / 60)
            for n in range(3):
                self.assertAlmostEqual(float(world.prop(n).state[1][2]), 0.1, 2)
            with self.assertRaisesRegex(sinew.Error, "no such"):
                world.keep_apart((sinew.BodyKind.PROP, 0), (sinew.BodyKind.PROP, 3))

    def test_graphs_are_followed(self):
        scene = Everything()
        asked = []

        def below(point):
            asked.append(point)
            return 0.1

        other = scene.world.add_character(scene.asset)
        other.add_graph(scene.graph, below, place=(1, 0))
        other.set_parameter("speed", 1.2)
        for _ in range(60):
            other.play_graph(1 / 60)
            scene.world.step(1 / 60)
        self.assertGreater(other.graph_place.place[0], 1.3)  # m, in a second, from 1 m on
        machine = scene.graph.info.nodes - 1
        self.assertEqual(scene.graph.node(machine).type, sinew.NodeType.MACHINE)
        self.assertEqual(other.machine(machine).name, b"move")
        self.assertEqual(asked, [])  # this graph has no feet
        saved = other.save_graph()
        other.play_graph(0.5)
        place = other.graph_place.place[0]
        other.restore_graph(saved)
        other.play_graph(0.5)
        self.assertEqual(other.graph_place.place[0], place)
        with self.assertRaisesRegex(sinew.Error, "another size"):
            other.restore_graph(saved[:-1])
        with self.assertRaisesRegex(sinew.Error, "NOT_FOUND"):
            other.trigger("jump")

    def test_effects_act_and_are_taken_away(self):
        scene = Everything()
        with self.assertRaisesRegex(sinew.Error, "density"):
            scene.effect.set(density=-1)
        scene.effect.set(velocity=(0, 30, 0))
        for _ in range(20):
            scene.world.step(1 / 60)
        self.assertGreater(scene.prop.state[2][1], 0.01)  # m/s
        scene.effect.remove()
        with self.assertRaisesRegex(sinew.Error, "BAD_HANDLE"):
            scene.effect.set(density=1)
        head = scene.asset.find_role(sinew.Role.HEAD)
        scene.character.add_joint_spring([head], stiffness=5)
        with self.assertRaisesRegex(sinew.Error, "not simulated"):
            scene.character.add_wind([head, 1000])
        scene.character.remove_effects()

    def test_poses_are_blended_mirrored_and_corrected(self):
        scene = Everything()
        asset = scene.asset
        a, b = asset.sample(0, 0.1), asset.sample(0, 0.5)
        out = asset.blend([(a, 1.0), (b, 0.0)])
        self.assertEqual(bytes(out), bytes(a))
        half = asset.blend([sinew.Layer(a), sinew.Layer(b, 0.5, mode=sinew.BlendMode.OVERRIDE, mask=[0.0] * len(a))])
        self.assertEqual(bytes(half), bytes(a))
        with self.assertRaisesRegex(sinew.Error, "weight"):
            asset.blend([sinew.Layer(a, -1.0)])
        hand, forearm = (asset.find_role(role) for role in (sinew.Role.HAND_L, sinew.Role.FOREARM_L))
        upper = asset.find_role(sinew.Role.UPPER_ARM_L)
        at = asset.model(a)
        target = [float(x) for x in at[hand][4:]]
        target[2] += 0.05  # where the arm is bent, not nearly straight
        asset.two_bone(a, upper, forearm, hand, target)
        for is_, wanted in zip(asset.model(a)[hand][4:], target):
            self.assertAlmostEqual(float(is_), wanted, 3)
        self.assertEqual(asset.partner(hand), asset.find_role(sinew.Role.HAND_R))
        asset.mirror(a)
        self.assertAlmostEqual(float(asset.model(a)[asset.partner(hand)][5]), -target[1], 3)
        old, new = asset.sample(0, 0.1), asset.sample(0, 0.6)
        transition = sinew.Transition(asset, old, new, 0.2)
        transition(asset, new, 0)
        self.assertAlmostEqual(float(new[hand]["rotation"][0]), float(old[hand]["rotation"][0]), 4)
        with self.assertRaisesRegex(sinew.Error, "step"):
            transition(asset, new, -1)
        look = sinew.Look()
        look(asset, a, (5, 0, 1), step=1 / 60)
        self.assertEqual(look.state.started, 1)
        with self.assertRaisesRegex(sinew.Error, "0 to 1"):
            look(asset, a, (5, 0, 1), 1 / 60, weight=2)

    def test_clips_are_played_without_a_graph(self):
        scene = Everything()
        asset, walk = scene.asset, scene.asset.find_clip("walk")
        duration = asset.clip(walk).duration
        steps = [e for k in range(60) for e in asset.passed_events(walk, duration * k / 60, duration * (k + 1) / 60)]
        self.assertEqual(len(steps), len(asset.passed_events(walk, 0, duration)))
        self.assertGreater(len(steps), 1)
        with self.assertRaisesRegex(sinew.Error, "TOO_SMALL"):
            asset.passed_events(walk, 0, 5 * duration, most=1)
        ended = asset.ended_events(asset.find_clip("get_up_supine"), 0.5)
        self.assertEqual([(e.name, e.kind) for e in ended], [(asset.find_event("helpless"), sinew.EventKind.END)])
        self.assertEqual(len(asset.curves(walk, 0.3)), asset.info.curves)
        jets = sinew.place_jets(asset.sample(walk, 0.3), (2, 0, 0), (0, 0, math.sqrt(0.5), math.sqrt(0.5)))
        travel, body = sinew.split_root(jets)
        self.assertGreater(float(travel["velocity"][0][1]), 0.5)  # m/s, to the left now
        self.assertAlmostEqual(float(travel["translation"][0][0]), 2, 0)
        chest = asset.find_role(sinew.Role.CHEST)
        self.assertGreater(float(asset.socket(jets, chest, (0, 0, 0.1))["velocity"][0][1]), 0.5)
        speed = sinew.CurveValue(0, 0, 0)
        for _ in range(60):
            sinew.smooth(speed, 2, 0.1, 1 / 60)
        self.assertAlmostEqual(speed.value, 2, 3)
        with self.assertRaisesRegex(sinew.Error, "half_life"):
            sinew.smooth(speed, 2, 0, 1 / 60)

    def test_what_was_set_is_read_again(self):
        scene = Everything()
        hero = scene.character
        hero.set_strength(0.5)
        hero.set_activation([0.5] * scene.asset.info.joints)
        hero.set_self_collision(sinew.SelfCollision.ON)
        hero.set_detail(2, sinew.Level.PARTIAL, 3, True)
        self.assertEqual((hero.strength, hero.detail), (0.5, (2, sinew.Level.PARTIAL, 3, True)))
        hero.park()
        self.assertTrue(hero.parked)
        hero.park(False)
        self.assertFalse(hero.parked)
        self.assertEqual(hero.ground[0], hero.report.ground_force)
        hero.ride(0.01, 0, 0)
        self.assertAlmostEqual(hero.displacement[0], 0.01)
        hero.come_back()
        hero.give_hand()
        hero.keep_out(0.002)
        self.assertEqual([scene.world.count(k) for k in (sinew.BodyKind.CHARACTER, sinew.BodyKind.PROP)], [1, 1])
        self.assertNotEqual(scene.world.snapshot_field(100)[1], "")
        scene.world.add_convex_solid([(0, 0, 1, 0.5), (0, 0, -1, 0.5)], 0.5)
        wedge = [(x, y, z) for x, z in ((0, 0), (0.6, 0), (0, 0.3)) for y in (0, 0.5)]
        scene.world.add_convex_obstacle(wedge, friction=0.5)
        self.assertEqual(scene.world.count(sinew.BodyKind.PROP), 1)
        scene.world.add_convex_prop(wedge, mass=3)
        self.assertEqual(scene.world.count(sinew.BodyKind.PROP), 2)
        with self.assertRaisesRegex(sinew.Error, "plane"):
            scene.world.add_convex_prop(wedge[::2] + wedge[:1])
        with self.assertRaisesRegex(sinew.Error, "unit"):
            scene.world.add_convex_solid([(0, 0, 2, 0.5)], 0.5)
        scene.street.step(1 / 60)
        self.assertAlmostEqual(scene.street.track(0).time, 1 / 60)
        self.assertGreater(scene.street.root_velocity(0)[0], 0.5)
        scene.street.set_strength(0, 0.5)

    def test_feet_stand_on_what_rays_met(self):
        asset = Everything().asset
        legs = [asset.leg(role) for role in (sinew.Role.FOOT_L, sinew.Role.FOOT_R)]
        self.assertEqual(legs[1].foot, asset.find_role(sinew.Role.FOOT_R))
        with self.assertRaisesRegex(sinew.Error, "role of a foot"):
            asset.leg(sinew.Role.HEAD)
        stand = asset.find_clip("stand")
        self.assertTrue(asset.in_contact(stand, 0, legs[0].foot))
        feet, lift = sinew.Feet(), sinew.jets_for(1)
        lift["rotation"][0], lift["translation"][0] = (0, 0, 0, 1), (0, 0, 0.05)
        floor, stair = sinew.ground_hit((0, 0, 0)), sinew.ground_hit((0, 0, 0.05), body=0)
        animated = asset.model(asset.sample(stand, 0))
        for frame in range(60):
            jets = asset.sample(stand, 0)
            feet(asset, jets, sinew.Foot(1, [floor]), sinew.Foot(1, [stair]), frame and 1 / 60, lift)
        placed = asset.model(jets)
        for leg, raised in zip(legs, (0, 0.05)):  # m
            self.assertAlmostEqual(float(placed[leg.foot][6] - animated[leg.foot][6]), raised, 2)
        self.assertEqual([foot.ground for foot in feet.state.feet], [-1, 0])
        self.assertNotEqual(feet.state.feet[1].hold, sinew.FootHold.FREE)
        with self.assertRaisesRegex(sinew.Error, "not given"):
            feet(asset, jets, sinew.Foot(1), sinew.Foot(1), 1 / 60)
        with self.assertRaisesRegex(sinew.Error, "follow"):
            feet(asset, jets, sinew.Foot(1), sinew.Foot(1), 1 / 60, lift, follow=2)

    def test_layers_in_model_space_do_not_lean_with_the_body(self):
        asset = Everything().asset
        a, b, added = asset.sample(0, 0.1), asset.sample(0, 0.5), asset.sample(0, 0.5)
        asset.subtract_in_model(added, a)
        asset.add_in_model(a, added)
        for one, other in zip(asset.model(a), asset.model(b)):
            for k in range(4):
                self.assertAlmostEqual(abs(float(one[k])), abs(float(other[k])), 4)
        asset.subtract_in_model(added)
        with self.assertRaisesRegex(sinew.Error, "weight"):
            asset.add_in_model(a, added, -1.0)

    def test_strands_cloth_and_tissue_hang(self):
        scene = Everything()
        corners = [(0, 0, 2), (1, 0, 2), (0, 1, 2), (0, 0, 3)]
        cloth = scene.world.add_cloth(corners[:3], [(0, 1, 2)], fixed=[0])
        tissue = scene.world.add_soft_tissue(corners, [(0, 1, 2, 3)], fixed=[3])
        for _ in range(10):
            scene.world.step(1 / 60)
        self.assertEqual((len(cloth.nodes), len(tissue.nodes)), (3, 4))
        self.assertAlmostEqual(cloth.nodes[0].position[2], 2, 5)
        self.assertLess(cloth.nodes[1].position[2], 1.999)
        cloth.reset()
        with self.assertRaisesRegex(sinew.Error, "element"):
            scene.world.add_cloth(corners, [(0, 1, 7)])
        scene.character.set_tone(sinew.Tone.BRACED)
        self.assertGreater(scene.character.stiffness(8)[0], 0)

    def test_a_crowd_walks_and_one_of_it_is_pushed(self):
        with sinew.Asset(ASSET) as asset, sinew.Crowd(asset, capacity=10, places=2) as crowd:
            for n in range(10):
                crowd.play(n, time=0.1 * n, translation=(2 * n, 0, 0))
            crowd.step(1 / 60)
            self.assertEqual(crowd.crowd_report.in_world, 0)
            joints = len(crowd.model(3))
            models = crowd.copy_models()
            self.assertEqual(list(models[3 * joints]), list(crowd.model(3)[0]))
            self.assertLess(abs(float(crowd.model(3)[0][4]) - 6), 1)
            crowd.push(3, asset.find_role(sinew.Role.CHEST), (90, 0, 0))
            crowd.step(1 / 60)
            self.assertEqual(crowd.crowd_report.in_world, 1)
            self.assertNotEqual(crowd.member(3).character, 0)
            saved, there = crowd.save(), crowd.copy_models()
            crowd.stop(3)
            crowd.step(1 / 60)
            self.assertEqual(crowd.crowd_report.in_world, 0)
            crowd.restore(saved)
            self.assertEqual(crowd.crowd_report.in_world, 1)
            self.assertEqual(bytes(crowd.copy_models()), bytes(there))

    def test_refused_calls_are_heard_of(self):
        heard = []
        sinew.set_log(lambda *words: heard.append(words))
        with self.assertRaises(sinew.Error):
            sinew.Asset("/nowhere")
        sinew.set_log(None)
        with self.assertRaises(sinew.Error):
            sinew.Asset("/nowhere")
        self.assertEqual(heard, [(sinew.LogLevel.ERROR, "file cannot be opened", -1)])

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
    GRAPH = sys.argv[2]
    with open(sys.argv[3], encoding="utf-8") as file:
        ABI = json.load(file)
    unittest.main(argv=sys.argv[:1])
