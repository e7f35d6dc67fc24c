"""Worlds, and clips that many characters follow."""
import ctypes
from ctypes import byref

from . import _abi
from ._abi import SnapshotPart, Status
from ._core import check, Error, floats, lib, numpy, Owned, report_of, saved, set_fields, settings_of, three
from .members import Character, Loop, Particles, Prop, Sensor


class Plays:
    """Clips that many characters follow, set in one call: `time`, `rate`, `rate_change` and `clip` are arrays, [character]."""

    def __init__(self, characters, asset, clip=0):
        self._keep = (list(characters), asset)
        self._plays = (_abi.Play * len(self._keep[0]))()
        for play, character in zip(self._plays, self._keep[0]):
            play.character, play.asset, play.clip, play.rate = character.handle, asset.handle, clip, 1
        self._address = ctypes.addressof(self._plays)
        if numpy is not None:
            records = numpy.ctypeslib.as_array(self._plays)
            self.clip, self.time, self.rate, self.rate_change = (
                records[name] for name in ("clip", "time", "rate", "rate_change"))

    def __getitem__(self, index):
        return self._plays[index]

    def __call__(self):
        check(lib.sinew_play_clips(self._address, len(self._plays)))


class World(Owned):
    """Characters, props, surroundings."""

    def __init__(self, preset=None, **settings):
        struct = settings_of(_abi.WorldSettings, lib.sinew_world_settings_init, {})
        if preset is not None:
            check(lib.sinew_world_settings_use_preset(byref(struct), preset.encode()))
        out = ctypes.c_uint64()
        check(lib.sinew_world_create(byref(set_fields(struct, settings)), byref(out)))
        super().__init__(out.value, lib.sinew_world_destroy)

    def step(self, h):
        check(lib.sinew_world_step(self.handle, h))

    @property
    def report(self):
        return report_of(_abi.WorldReport, lib.sinew_world_get_report, self.handle)

    @property
    def memory(self):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_memory(self.handle, byref(out)))
        return out.value

    def _add(self, kind, init, add, settings, *before):
        struct = settings_of(kind, init, settings)
        out = ctypes.c_uint64()
        check(add(self.handle, *before, byref(struct), byref(out)))
        return out.value

    def add_character(self, asset, **settings):
        return Character(self, self._add(_abi.CharacterSettings, lib.sinew_character_settings_init, lib.sinew_world_add_character,
                                         settings, asset.handle))

    def add_prop(self, **settings):
        return Prop(self, self._add(_abi.PropSettings, lib.sinew_prop_settings_init, lib.sinew_world_add_prop, settings))

    def add_convex_prop(self, points, **settings):
        """`points`: three numbers each, m, in the axes of the prop's pose."""
        struct = settings_of(_abi.PropSettings, lib.sinew_prop_settings_init, settings)
        numbers = (ctypes.c_double * (3 * len(points)))(*(float(x) for point in points for x in point))
        out = ctypes.c_uint64()
        check(lib.sinew_world_add_convex_prop(self.handle, byref(struct), numbers, len(points), byref(out)))
        return Prop(self, out.value)

    def add_loop(self, **settings):
        return Loop(self, self._add(_abi.LoopSettings, lib.sinew_loop_settings_init, lib.sinew_world_add_loop, settings))

    def add_strand(self, **settings):
        return Particles(self, self._add(_abi.Strand, lib.sinew_strand_init, lib.sinew_world_add_strand, settings))

    def _add_mesh(self, kind, init, add, positions, elements, names, fixed, settings):
        """Nodes, elements of them, and which are fixed, as the C structs hold them."""
        struct, out = settings_of(kind, init, settings), ctypes.c_uint64()
        nodes = (ctypes.c_double * (3 * len(positions)))(*(x for p in positions for x in p))
        indices = (ctypes.c_int32 * sum(map(len, elements)))(*(n for e in elements for n in e))
        riding = (ctypes.c_int32 * len(fixed))(*fixed)
        struct.positions, struct.node_count = ctypes.addressof(nodes), len(positions)
        struct.fixed, struct.fixed_count = ctypes.addressof(riding), len(fixed)
        setattr(struct, names[0], ctypes.addressof(indices))
        setattr(struct, names[1], len(elements))
        check(add(self.handle, byref(struct), byref(out)))
        return Particles(self, out.value)

    def add_cloth(self, positions, triangles, fixed=(), **settings):
        """`positions` m, `triangles` of three nodes, `fixed`: nodes that ride on `frame`."""
        return self._add_mesh(_abi.Cloth, lib.sinew_cloth_init, lib.sinew_world_add_cloth, positions, triangles,
                              ("triangles", "triangle_count"), fixed, settings)

    def add_soft_tissue(self, positions, tetrahedra, fixed=(), **settings):
        return self._add_mesh(_abi.SoftTissue, lib.sinew_soft_tissue_init, lib.sinew_world_add_soft_tissue, positions, tetrahedra,
                              ("tetrahedra", "tetrahedron_count"), fixed, settings)

    def add_obstacle(self, **settings):
        check(lib.sinew_world_add_obstacle(self.handle, byref(settings_of(_abi.Obstacle, lib.sinew_obstacle_init, settings))))

    def add_convex_obstacle(self, points, **settings):
        """`points`: three numbers each, m, in the axes of the obstacle's pose."""
        struct = settings_of(_abi.Obstacle, lib.sinew_obstacle_init, settings)
        numbers = (ctypes.c_double * (3 * len(points)))(*(float(x) for point in points for x in point))
        check(lib.sinew_world_add_convex_obstacle(self.handle, byref(struct), numbers, len(points)))

    def add_height_field(self, heights, **settings):
        """`heights`: rows of columns, m."""
        rows = [list(map(float, row)) for row in heights]
        flat = [x for row in rows for x in row]
        struct = settings_of(_abi.HeightField, lib.sinew_height_field_init, settings)
        struct.rows, struct.columns = len(rows), len(rows[0])
        if len(flat) != struct.rows * struct.columns:
            raise TypeError("rows of different lengths")
        numbers = (ctypes.c_double * len(flat))(*flat)
        struct.heights = ctypes.addressof(numbers)
        check(lib.sinew_world_add_height_field(self.handle, byref(struct)))

    def add_convex_solid(self, faces, inner_radius, **settings):
        """`faces`: unit outward normal and m from the world's origin along it, four numbers each; `inner_radius`: m, of a ball
        that fits inside."""
        struct = settings_of(_abi.ConvexSolid, lib.sinew_convex_solid_init, settings)
        numbers = (ctypes.c_double * (4 * len(faces)))(*(float(x) for face in faces for x in face))
        struct.faces, struct.face_count, struct.inner_radius = ctypes.addressof(numbers), len(faces), inner_radius
        check(lib.sinew_world_add_convex_solid(self.handle, byref(struct)))

    def keep_apart(self, a, b, apart=True):
        """Whether two bodies, (BodyKind, index) each, pass through each other."""
        bodies = [_abi.Body(kind, index, 0) for kind, index in (a, b)]
        check(lib.sinew_world_keep_apart(self.handle, byref(bodies[0]), byref(bodies[1]), apart))

    def count(self, kind):
        """How many characters, props or particle bodies there are (BodyKind)."""
        out = ctypes.c_int32()
        check(lib.sinew_world_get_count(self.handle, kind, byref(out)))
        return out.value

    def snapshot_field(self, byte):
        """What a byte of save() stands for: which body (-1: the world), and the field's name."""
        out = _abi.SnapshotField()
        check(lib.sinew_world_get_snapshot_field(self.handle, byte, byref(out)))
        return out.body, out.name.decode()

    def character(self, index):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_character(self.handle, index, byref(out)))
        return Character(self, out.value)

    def prop(self, index):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_prop(self.handle, index, byref(out)))
        return Prop(self, out.value)

    def _copied(self, copy):
        count = ctypes.c_int32()
        status = copy(self.handle, None, 0, byref(count))
        if status not in (Status.OK, Status.TOO_SMALL):
            raise Error(status)
        out = (_abi.Transform * count.value)()
        check(copy(self.handle, byref(out), count.value, byref(count)))
        return floats(out, count.value, 8, 7)

    def copy_models(self):
        """Of all joints of all characters: rotation x y z w, translation."""
        return self._copied(lib.sinew_world_copy_models)

    def report_contacts(self, **settings):
        check(lib.sinew_world_report_contacts(
            self.handle, byref(settings_of(_abi.ContactSettings, lib.sinew_contact_settings_init, settings))))

    def contacts(self, most=256):
        """Takes the events that wait."""
        out, count = (_abi.ContactEvent * most)(), ctypes.c_int32()
        check(lib.sinew_world_take_contacts(self.handle, byref(out), most, byref(count), None))
        return out[:count.value]

    def _query(self, find, most, settings):
        struct = set_fields(settings_of(_abi.Query, lib.sinew_query_init, {}), settings)
        out, count = (_abi.Hit * most)(), ctypes.c_int32()
        check(find(self.handle, byref(struct), byref(out), most, byref(count)))
        return out[:count.value]

    def cast(self, start, motion, most=1, **settings):
        """The nearest hits of a ray, ball (`radius`) or capsule (`half_axis`)."""
        return self._query(lib.sinew_world_cast, most, {"origin": start, "motion": motion, **settings})

    def overlap(self, start, radius, most=16, **settings):
        return self._query(lib.sinew_world_overlap, most, {"origin": start, "radius": radius, **settings})

    def add_sensor(self, at, radius, bodies=64, **settings):
        """A ball or a capsule (`half_axis`) that tells who comes in and who leaves: characters, props and particles, or `kinds`."""
        sensor = Sensor(self, 0, bodies)
        query = sensor._query(at, radius, settings)
        out = ctypes.c_uint64()
        check(lib.sinew_world_add_sensor(self.handle, byref(query), bodies, byref(out)))
        sensor.handle = out.value
        return sensor

    def draw(self, line=None, triangle=None, text=None, **settings):
        """line(from, to, colour), triangle(a, b, c, colour), text(at, words, colour); colours 0xRRGGBBAA."""
        struct = settings_of(_abi.DrawSettings, lib.sinew_draw_settings_init, settings)

        def at(address):
            return tuple((ctypes.c_double * 3).from_address(address))

        if line:
            struct.line = _abi.DrawLine(lambda _, a, b, colour: line(at(a), at(b), colour))
        if triangle:
            struct.triangle = _abi.DrawTriangle(lambda _, a, b, c, colour: triangle(at(a), at(b), at(c), colour))
        if text:
            struct.text = _abi.DrawText(lambda _, a, words, colour: text(at(a), words.decode(), colour))
        check(lib.sinew_world_draw(self.handle, byref(struct)))

    def save(self, part=SnapshotPart.STATE):
        return saved(lib.sinew_world_save, self.handle, part)

    def restore(self, snapshot, part=SnapshotPart.STATE):
        check(lib.sinew_world_restore(self.handle, part, bytes(snapshot), len(snapshot)))

    def record(self, begin=True):
        check(lib.sinew_world_record(self.handle, begin))

    @property
    def recording(self):
        view = _abi.View()
        check(lib.sinew_world_get_recording(self.handle, byref(view)))
        return ctypes.string_at(view.data, view.count)

    def replay(self, recording):
        report = _abi.ReplayReport(size=ctypes.sizeof(_abi.ReplayReport))
        check(lib.sinew_world_replay(self.handle, bytes(recording), len(recording), byref(report)))
        return report


class Crowd(World):
    """A world with many characters of one asset on their clips, of whom it simulates a few at a time (sinew_crowd.h). `world`
    and `character` are settings of those, as dictionaries."""

    def __init__(self, asset, world={}, character={}, **settings):
        parts = [settings_of(_abi.CrowdSettings, lib.sinew_crowd_settings_init, settings),
                 settings_of(_abi.WorldSettings, lib.sinew_world_settings_init, world),
                 settings_of(_abi.CharacterSettings, lib.sinew_character_settings_init, character)]
        out = ctypes.c_uint64()
        check(lib.sinew_crowd_create(asset.handle, *map(byref, parts), byref(out)))
        Owned.__init__(self, out.value, lib.sinew_world_destroy)

    def play(self, character, clip=0, time=0, rate=1, rotation=(0, 0, 0, 1), translation=(0, 0, 0)):
        """From now on one plays this, at that place."""
        track = _abi.CrowdTrack(character=character, clip=clip, time=time, rate=rate)
        track.place.rotation[:], track.place.translation[:] = rotation, translation
        check(lib.sinew_crowd_play(self.handle, byref(track), 1))

    def stop(self, character):
        """It is gone until it plays again."""
        check(lib.sinew_crowd_stop(self.handle, character))

    def push(self, character, joint, impulse):
        """N s, at the joint."""
        check(lib.sinew_crowd_push(self.handle, character, joint, three(impulse)))

    def set_strength(self, character, strength):
        """Of all its muscles, until it is stopped."""
        check(lib.sinew_crowd_set_strength(self.handle, character, strength))

    def track(self, character):
        """What it plays, at the time that it is at."""
        out = _abi.CrowdTrack()
        check(lib.sinew_crowd_get_track(self.handle, character, byref(out)))
        return out

    def root_velocity(self, character):
        """m/s, world, as its clip moves it."""
        out = (ctypes.c_float * 3)()
        check(lib.sinew_crowd_get_root_velocity(self.handle, character, out))
        return tuple(out)

    def member(self, character):
        out = _abi.CrowdMember(size=ctypes.sizeof(_abi.CrowdMember))
        check(lib.sinew_crowd_get_member(self.handle, character, byref(out)))
        return out

    @property
    def crowd_report(self):
        return report_of(_abi.CrowdReport, lib.sinew_crowd_get_report, self.handle)

    def model(self, character):
        """[joint] rotation x y z w, translation, joint to world: a view until the next step."""
        view = _abi.View()
        check(lib.sinew_crowd_get_model(self.handle, character, byref(view)))
        memory = (ctypes.c_float * (view.count * view.stride // ctypes.sizeof(ctypes.c_float))).from_address(view.data)
        memory.owner = self._native
        return floats(memory, view.count, 8, 7)

    def copy_models(self):
        """The same of all, copied: [character * joints + joint]."""
        return self._copied(lib.sinew_crowd_copy_models)
