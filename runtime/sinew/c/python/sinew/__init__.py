"""Sinew from Python: a thin layer over the C interface (sinew.h says what each call means, in which units).

    import sinew
    with sinew.Asset("hero.sinew") as asset, sinew.World() as world:
        hero = world.add_character(asset)
        for frame in range(180):
            hero.play(asset, 0, frame / 60)
            world.step(1 / 60)
            print(hero.model[0])           # rotation x y z w, then translation: a view, not a copy

Settings are keyword arguments with the names of the C structs' fields. A status that is not OK is raised as Error. Arrays are
numpy's where numpy is installed, else memoryviews (of poses one for each joint); those that a property gives are views of the world's own memory: they show what
the last step left when they are asked for again, and keep that memory while they live, also after close()."""
import ctypes
import os
from ctypes import byref

from . import _abi
from ._abi import (AnchorKind, BehaviourEventKind, BehaviourOrder, BehaviourReason, BehaviourState, BlendMode, BodyKind, ContactPhase,
                   EventKind, GetUpPolicy, GroundKind, JointType, Level, LoopKind, NodeType, ParameterType, Role, RootDrive, Shape,
                   SnapshotPart, Status, Tone)

try:
    import numpy
except ImportError:
    numpy = None

lib = _abi.load(os.environ.get("SINEW_LIBRARY") or os.path.join(os.path.dirname(os.path.abspath(__file__)), "libsinew.so"))
__version__ = lib.sinew_version().decode()


class Error(Exception):
    """What the library refused: `status`, `reason`, `index` of the joint or element that the reason is about (-1: none)."""

    def __init__(self, status):
        self.status = Status(status)
        self.reason = lib.sinew_last_reason().decode()
        self.index = lib.sinew_last_index()
        about = f" ({self.index})" if self.index >= 0 else ""
        super().__init__(f"{self.status.name}: {self.reason}{about}")


def check(status):
    """Raises what is not OK."""
    if status:
        raise Error(status)


def _set(struct, values):
    """Sets fields by name; arrays from sequences, nested structs from dictionaries."""
    fields = dict(struct._fields_)
    for name, value in values.items():
        if name not in fields or name == "size":
            raise TypeError(f"{type(struct).__name__} has no field {name}")
        field = getattr(struct, name)
        if isinstance(field, ctypes.Structure):
            _set(field, value)
        elif isinstance(field, ctypes.Array):
            if len(value) != len(field):
                raise TypeError(f"{type(struct).__name__}.{name} has {len(field)} numbers")
            field[:] = [float(x) for x in value]
        elif isinstance(value, _Handle):
            setattr(struct, name, value.handle)
        else:
            setattr(struct, name, value)
    return struct


def _settings(kind, init, values):
    struct = kind(size=ctypes.sizeof(kind))
    check(init(byref(struct)))
    return _set(struct, values)


def _effect(kind, init, joints, values):
    struct = _settings(kind, init, values)
    if joints is not None:
        numbers = (ctypes.c_int32 * len(joints))(*joints)
        struct.joints, struct.joint_count = ctypes.addressof(numbers), len(joints)
        struct.keep = numbers
    return struct


def _report(kind, get, handle):
    struct = kind(size=ctypes.sizeof(kind))
    check(get(handle, byref(struct)))
    return struct


def _saved(save, *arguments):
    """Bytes of a save that tells how many they are."""
    size = ctypes.c_size_t()
    status = save(*arguments, None, 0, byref(size))
    if status != Status.TOO_SMALL:
        raise Error(status)
    out = ctypes.create_string_buffer(size.value)
    check(save(*arguments, out, len(out), byref(size)))
    return out.raw[:size.value]


def _three(values):
    return (ctypes.c_double * 3)(*values)


def _pointer(array):
    """Address of a numpy array's or a ctypes array's memory."""
    return array.ctypes.data if numpy is not None and isinstance(array, numpy.ndarray) else ctypes.addressof(array)


def jets_for(joints):
    """Room for one jet (local motion) of each joint, as Asset.sample and Character.set_target take it: numpy records, or a
    ctypes array."""
    if numpy is None:
        return (_abi.Jet * joints)()
    kind = numpy.dtype({"names": [f[0] for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "formats": [(numpy.float32, f[1]._length_) for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "offsets": [getattr(_abi.Jet, f[0]).offset for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "itemsize": ctypes.sizeof(_abi.Jet)})
    memory = numpy.zeros(joints * kind.itemsize + 16, numpy.uint8)
    first = -memory.ctypes.data % 16  # jets lie at a multiple of 16
    return memory[first:first + joints * kind.itemsize].view(kind)


class _Native:
    """Owns a handle; views of its memory hold on to it, so that it outlives them."""

    def __init__(self, handle, destroy):
        self.handle, self.destroy = handle, destroy
        self.kept = []  # callbacks that the library may still call

    def __del__(self):
        self.destroy(self.handle)


class _Handle:
    handle = 0


class _Owned(_Handle):
    """Something that is destroyed by close(), at the end of a with, or when nobody refers to it any more."""

    def __init__(self, handle, destroy):
        self._native = _Native(handle, destroy)

    @property
    def handle(self):
        return self._native.handle if self._native else 0

    def close(self):
        self._native = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Layer:
    """One of the motions that Asset.blend mixes: jets, weight (a number, or value, rate and acceleration: ease()), mode, mask."""

    def __init__(self, jets, weight=1.0, mode=BlendMode.MIX, mask=None):
        self.jets, self.mode = jets, mode
        self.weight = (weight, 0.0, 0.0) if isinstance(weight, (int, float)) else tuple(weight)
        self.mask = None if mask is None else (ctypes.c_float * len(mask))(*mask)

    def _write(self, layer, count):
        if len(self.jets) < count or self.mask is not None and len(self.mask) < count:
            raise TypeError("a layer with fewer joints than are blended")
        layer.jets, layer.mode = _pointer(self.jets), self.mode
        layer.mask = None if self.mask is None else ctypes.addressof(self.mask)
        layer.weight, layer.weight_rate, layer.weight_acceleration = self.weight


def ease(elapsed, duration):
    """A weight from 0 to 1, with its rate and acceleration."""
    out = (ctypes.c_float * 3)()
    check(lib.sinew_ease(elapsed, duration, byref(out)))
    return tuple(out)


class Look:
    """What a character's look remembers: `state`, a struct that may be copied."""

    def __init__(self):
        self.state = _abi.LookState()

    def __call__(self, asset, jets, target, step, **settings):
        """Turns spine, neck and head of `jets` to the target (m, model space), `step` s after the last call."""
        struct = _settings(_abi.Look, lib.sinew_look_init, {"target": target, "step": step, **settings})
        check(lib.sinew_asset_look(asset.handle, byref(struct), byref(self.state), _pointer(jets), len(jets)))


class _Described(_Owned):
    """What has parts that are asked for by number or name."""

    def _element(self, kind, get, *index):
        struct = kind(size=ctypes.sizeof(kind))
        check(get(self.handle, *index, byref(struct)))
        return struct

    def _find(self, find, what):
        out = ctypes.c_int32()
        check(find(self.handle, what, byref(out)))
        return out.value


class Asset(_Described):
    """A skeleton and its clips, from a path or from the bytes of a file."""

    def __init__(self, source):
        out = ctypes.c_uint64()
        if isinstance(source, (bytes, bytearray)):
            check(lib.sinew_asset_read(bytes(source), len(source), byref(out)))
        else:
            check(lib.sinew_asset_load(os.fsencode(source), byref(out)))
        super().__init__(out.value, lib.sinew_asset_destroy)
        self.info = _report(_abi.AssetInfo, lib.sinew_asset_get_info, self.handle)

    def joint(self, index):
        return self._element(_abi.JointInfo, lib.sinew_asset_get_joint, index)

    def clip(self, index):
        return self._element(_abi.ClipInfo, lib.sinew_asset_get_clip, index)

    def muscle(self, index):
        return self._element(_abi.MuscleInfo, lib.sinew_asset_get_muscle, index)

    def event(self, index):
        return self._element(_abi.EventInfo, lib.sinew_asset_get_event, index)

    def curve(self, index):
        return self._element(_abi.CurveInfo, lib.sinew_asset_get_curve, index)

    def mask(self, index):
        """How far it reaches each joint, 0 to 1."""
        out, count = (ctypes.c_float * self.info.joints)(), ctypes.c_int32()
        check(lib.sinew_asset_get_mask(self.handle, index, byref(out), len(out), byref(count)))
        return list(out)

    def find_joint(self, name):
        return self._find(lib.sinew_asset_find_joint, name.encode())

    def find_role(self, role):
        return self._find(lib.sinew_asset_find_role, role)

    def find_clip(self, name):
        return self._find(lib.sinew_asset_find_clip, name.encode())

    def find_muscle(self, name):
        return self._find(lib.sinew_asset_find_muscle, name.encode())

    def find_event(self, name):
        """The number of its name, as GraphEvent.name has it."""
        out = ctypes.c_uint32()
        check(lib.sinew_asset_find_event(self.handle, name.encode(), byref(out)))
        return out.value

    def find_curve(self, name):
        return self._find(lib.sinew_asset_find_curve, name.encode())

    def find_mask(self, name):
        return self._find(lib.sinew_asset_find_mask, name.encode())

    def blend(self, layers, jets=None):
        """Of Layers, or pairs of jets and weight; into `jets` where given."""
        layers = [one if isinstance(one, Layer) else Layer(*one) for one in layers]
        jets = jets_for(self.info.joints) if jets is None else jets
        structs = (_abi.BlendLayer * max(len(layers), 1))()
        for struct, layer in zip(structs, layers):
            layer._write(struct, len(jets))
        check(lib.sinew_asset_blend(self.handle, byref(structs), len(layers), _pointer(jets), len(jets)))
        return jets

    def subtract(self, jets, reference=None):
        """Makes `jets` the difference from a pose, or from rest, as additive layers are."""
        address, count = (None, 0) if reference is None else (_pointer(reference), len(reference))
        check(lib.sinew_asset_subtract(self.handle, address, count, _pointer(jets), len(jets)))

    def partner(self, joint):
        """The joint on the other side; -1: none."""
        return self._find(lib.sinew_asset_get_partner, joint)

    def mirror(self, jets):
        """Exchanges left and right."""
        check(lib.sinew_asset_mirror(self.handle, _pointer(jets), len(jets)))

    def two_bone(self, jets, upper, middle, end, target, **settings):
        """Turns two joints of a limb so that its end comes to the target (m, model space)."""
        struct = _settings(_abi.TwoBone, lib.sinew_two_bone_init,
                           {"upper": upper, "middle": middle, "end": end, "target": target, **settings})
        check(lib.sinew_asset_two_bone(self.handle, byref(struct), _pointer(jets), len(jets)))

    def aim(self, jets, joint, target, **settings):
        """Turns a joint so that its axis points to the target (m, model space)."""
        struct = _settings(_abi.Aim, lib.sinew_aim_init, {"joint": joint, "target": target, **settings})
        check(lib.sinew_asset_aim(self.handle, byref(struct), _pointer(jets), len(jets)))

    def model(self, jets):
        """[joint] rotation x y z w, translation: joint to model."""
        out, count = (_abi.Transform * len(jets))(), ctypes.c_int32()
        check(lib.sinew_asset_get_model(self.handle, _pointer(jets), len(jets), byref(out), len(jets), byref(count)))
        return _floats(out, count.value, 8, 7)

    def sample(self, clip, time, rate=1.0, rate_change=0.0, jets=None):
        """Jets of all joints, into `jets` where given."""
        jets = jets_for(self.info.joints) if jets is None else jets
        check(lib.sinew_clip_sample(self.handle, clip, time, rate, rate_change, _pointer(jets), len(jets)))
        return jets


class Graph(_Described):
    """What may be done with an asset's clips (`sinew graph compile`), from a path or from the bytes of a file."""

    def __init__(self, source, asset):
        out = ctypes.c_uint64()
        if isinstance(source, (bytes, bytearray)):
            check(lib.sinew_graph_read(bytes(source), len(source), asset.handle, byref(out)))
        else:
            check(lib.sinew_graph_load(os.fsencode(source), asset.handle, byref(out)))
        super().__init__(out.value, lib.sinew_graph_destroy)
        self.info = _report(_abi.GraphInfo, lib.sinew_graph_get_info, self.handle)

    def parameter(self, index):
        return self._element(_abi.ParameterInfo, lib.sinew_graph_get_parameter, index)

    def node(self, index):
        return self._element(_abi.NodeInfo, lib.sinew_graph_get_node, index)

    def state(self, machine, index):
        return self._element(_abi.StateInfo, lib.sinew_graph_get_state, machine, index)

    def find_parameter(self, name):
        return self._find(lib.sinew_graph_find_parameter, name.encode())

    def find_node(self, name):
        return self._find(lib.sinew_graph_find_node, name.encode())


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


class World(_Owned):
    """Characters, props, surroundings."""

    def __init__(self, preset=None, **settings):
        struct = _settings(_abi.WorldSettings, lib.sinew_world_settings_init, {})
        if preset is not None:
            check(lib.sinew_world_settings_use_preset(byref(struct), preset.encode()))
        out = ctypes.c_uint64()
        check(lib.sinew_world_create(byref(_set(struct, settings)), byref(out)))
        super().__init__(out.value, lib.sinew_world_destroy)

    def step(self, h):
        check(lib.sinew_world_step(self.handle, h))

    @property
    def report(self):
        return _report(_abi.WorldReport, lib.sinew_world_get_report, self.handle)

    @property
    def memory(self):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_memory(self.handle, byref(out)))
        return out.value

    def _add(self, kind, init, add, settings, *before):
        struct = _settings(kind, init, settings)
        out = ctypes.c_uint64()
        check(add(self.handle, *before, byref(struct), byref(out)))
        return out.value

    def add_character(self, asset, **settings):
        return Character(self, self._add(_abi.CharacterSettings, lib.sinew_character_settings_init, lib.sinew_world_add_character,
                                         settings, asset.handle))

    def add_prop(self, **settings):
        return Prop(self, self._add(_abi.PropSettings, lib.sinew_prop_settings_init, lib.sinew_world_add_prop, settings))

    def add_loop(self, **settings):
        return Loop(self, self._add(_abi.LoopSettings, lib.sinew_loop_settings_init, lib.sinew_world_add_loop, settings))

    def add_strand(self, **settings):
        return Particles(self, self._add(_abi.Strand, lib.sinew_strand_init, lib.sinew_world_add_strand, settings))

    def _add_mesh(self, kind, init, add, positions, elements, names, fixed, settings):
        """Nodes, elements of them, and which are fixed, as the C structs hold them."""
        struct, out = _settings(kind, init, settings), ctypes.c_uint64()
        nodes = (ctypes.c_double * (3 * len(positions)))(*(x for p in positions for x in p))
        indices = (ctypes.c_int32 * sum(map(len, elements)))(*(n for e in elements for n in e))
        held = (ctypes.c_int32 * len(fixed))(*fixed)
        struct.positions, struct.node_count = ctypes.addressof(nodes), len(positions)
        struct.fixed, struct.fixed_count = ctypes.addressof(held), len(fixed)
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
        check(lib.sinew_world_add_obstacle(self.handle, byref(_settings(_abi.Obstacle, lib.sinew_obstacle_init, settings))))

    def add_height_field(self, heights, **settings):
        """`heights`: rows of columns, m."""
        rows = [list(map(float, row)) for row in heights]
        flat = [x for row in rows for x in row]
        struct = _settings(_abi.HeightField, lib.sinew_height_field_init, settings)
        struct.rows, struct.columns = len(rows), len(rows[0])
        if len(flat) != struct.rows * struct.columns:
            raise TypeError("rows of different lengths")
        numbers = (ctypes.c_double * len(flat))(*flat)
        struct.heights = ctypes.addressof(numbers)
        check(lib.sinew_world_add_height_field(self.handle, byref(struct)))

    def character(self, index):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_character(self.handle, index, byref(out)))
        return Character(self, out.value)

    def prop(self, index):
        out = ctypes.c_uint64()
        check(lib.sinew_world_get_prop(self.handle, index, byref(out)))
        return Prop(self, out.value)

    def copy_models(self):
        """Of all joints of all characters: rotation x y z w, translation."""
        count = ctypes.c_int32()
        status = lib.sinew_world_copy_models(self.handle, None, 0, byref(count))
        if status not in (Status.OK, Status.TOO_SMALL):
            raise Error(status)
        out = (_abi.Transform * count.value)()
        check(lib.sinew_world_copy_models(self.handle, byref(out), count.value, byref(count)))
        return _floats(out, count.value, 8, 7)

    def report_contacts(self, **settings):
        check(lib.sinew_world_report_contacts(
            self.handle, byref(_settings(_abi.ContactSettings, lib.sinew_contact_settings_init, settings))))

    def contacts(self, most=256):
        """Takes the events that wait."""
        out, count = (_abi.ContactEvent * most)(), ctypes.c_int32()
        check(lib.sinew_world_take_contacts(self.handle, byref(out), most, byref(count), None))
        return out[:count.value]

    def _query(self, find, most, settings):
        struct = _set(_settings(_abi.Query, lib.sinew_query_init, {}), settings)
        out, count = (_abi.Hit * most)(), ctypes.c_int32()
        check(find(self.handle, byref(struct), byref(out), most, byref(count)))
        return out[:count.value]

    def cast(self, start, motion, most=1, **settings):
        """The nearest hits of a ray, ball (`radius`) or capsule (`half_axis`)."""
        return self._query(lib.sinew_world_cast, most, {"origin": start, "motion": motion, **settings})

    def overlap(self, start, radius, most=16, **settings):
        return self._query(lib.sinew_world_overlap, most, {"origin": start, "radius": radius, **settings})

    def draw(self, line=None, triangle=None, text=None, **settings):
        """line(from, to, colour), triangle(a, b, c, colour), text(at, words, colour); colours 0xRRGGBBAA."""
        struct = _settings(_abi.DrawSettings, lib.sinew_draw_settings_init, settings)

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
        return _saved(lib.sinew_world_save, self.handle, part)

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


def _floats(memory, rows, stride, columns):
    """Memory of floats as [rows, columns], without a copy."""
    if numpy is None:
        flat = memoryview(memory).cast("B").cast("f")
        return [flat[row * stride:row * stride + columns] for row in range(rows)] if columns > 1 else flat
    array = numpy.frombuffer(memory, numpy.float32).reshape(rows, stride)[:, :columns]
    return array if columns > 1 else array[:, 0]


class _InWorld(_Handle):
    def __init__(self, world, handle):
        self.world, self.handle = world, handle

    def _call(self, function, *arguments):
        check(function(self.handle, *arguments))


    def _add_effect(self, add, effect, joints, settings):
        struct, out = _effect(*effect[:2], joints, settings), ctypes.c_uint64()
        self._call(add, byref(struct), byref(out))
        return Effect(self.world, out.value, *effect)


class Effect(_InWorld):
    """What acts on a character or prop."""

    def __init__(self, world, handle, kind, init, change):
        super().__init__(world, handle)
        self._kind, self._init, self._change = kind, init, change

    def set(self, **settings):
        """From the next step on; what is not named has its default."""
        self._call(self._change, byref(_settings(self._kind, self._init, settings)))

    def remove(self):
        self._call(lib.sinew_effect_remove)


_WIND = (_abi.Wind, lib.sinew_wind_init, lib.sinew_effect_set_wind)
_BUOYANCY = (_abi.Buoyancy, lib.sinew_buoyancy_init, lib.sinew_effect_set_buoyancy)
_FORCE_FIELD = (_abi.ForceField, lib.sinew_force_field_init, lib.sinew_effect_set_force_field)
_JOINT_SPRING = (_abi.JointSpring, lib.sinew_joint_spring_init, lib.sinew_effect_set_joint_spring)


class Character(_InWorld):
    def play(self, asset, clip, time, rate=1.0, rate_change=0.0):
        """What a clip shows then is wanted at the end of the next step."""
        play = _abi.Play(self.handle, asset.handle, clip, 0, time, rate, rate_change)
        check(lib.sinew_play_clips(byref(play), 1))

    def set_target(self, jets):
        self._call(lib.sinew_character_set_target, _pointer(jets), len(jets))

    def reset(self):
        self._call(lib.sinew_character_reset)

    def set_strength(self, strength, joint=None, muscle=None, group=None):
        """Of all muscles, or of the subtree below a joint, one muscle, or a group."""
        if joint is not None:
            self._call(lib.sinew_character_set_joint_strength, joint, strength)
        elif muscle is not None:
            self._call(lib.sinew_character_set_muscle_strength, muscle, strength)
        elif group is not None:
            self._call(lib.sinew_character_set_group_strength, group.encode(), strength)
        else:
            self._call(lib.sinew_character_set_strength, strength)

    def set_tone(self, tone, joint=None, group=None):
        """How stiffly muscles stay with the animation: of all, those below a joint, or a group."""
        if joint is not None:
            self._call(lib.sinew_character_set_joint_tone, joint, tone)
        elif group is not None:
            self._call(lib.sinew_character_set_group_tone, group.encode(), tone)
        else:
            self._call(lib.sinew_character_set_tone, tone)

    def set_stiffness(self, joint, stiffness, damping_ratio):
        self._call(lib.sinew_character_set_joint_stiffness, joint, stiffness, damping_ratio)

    def stiffness(self, dof):
        """N m/rad (infinite: rigid), and the damping ratio."""
        stiffness, ratio = ctypes.c_double(), ctypes.c_double()
        self._call(lib.sinew_character_get_stiffness, dof, byref(stiffness), byref(ratio))
        return stiffness.value, ratio.value

    def set_root_drive(self, drive):
        self._call(lib.sinew_character_set_root_drive, drive)

    def set_help(self, force, torque):
        self._call(lib.sinew_character_set_help, force, torque)

    def set_detail(self, significance=1.0, most=Level.SUBSTEPS, check_every=1, bake=False):
        self._call(lib.sinew_character_set_detail, significance, most, check_every, bake)

    @property
    def displacement(self):
        """x, y (m), yaw (rad)."""
        out = (ctypes.c_double * 3)()
        self._call(lib.sinew_character_get_displacement, byref(out))
        return tuple(out)

    def take_displacement(self):
        self._call(lib.sinew_character_take_displacement)

    def displace(self, x, y, yaw):
        self._call(lib.sinew_character_displace, _three((x, y, yaw)))

    def apply_impulse(self, joint, point, impulse):
        self._call(lib.sinew_character_apply_impulse, joint, _three(point), _three(impulse))

    def apply_force(self, joint, point, force):
        self._call(lib.sinew_character_apply_force, joint, _three(point), _three(force))

    def park(self, parked=True):
        self._call(lib.sinew_character_park, parked)

    def add_behaviour(self, **settings):
        self._call(lib.sinew_character_add_behaviour,
                   byref(_settings(_abi.BehaviourSettings, lib.sinew_behaviour_settings_init, settings)))

    def use_get_ups(self, asset):
        """The clips by which it gets up: those of the asset named get_up... and roll..."""
        self._call(lib.sinew_character_use_get_ups, asset.handle)

    def balance(self, jets, h):
        """Changes `jets` where the behaviour acts, and makes them the target."""
        self._call(lib.sinew_character_balance, _pointer(jets), len(jets), h)

    def order(self, order):
        self._call(lib.sinew_character_order, order)

    @property
    def behaviour(self):
        return _report(_abi.BehaviourReport, lib.sinew_character_get_behaviour, self.handle)

    @property
    def behaviour_events(self):
        """What happened in the last balance()."""
        out, count = (_abi.BehaviourEvent * 4)(), ctypes.c_int32()
        self._call(lib.sinew_character_get_behaviour_events, byref(out), 4, byref(count))
        return out[:count.value]

    def add_wind(self, joints=None, **settings):
        """On the colliders of these joints (numbers), or of all."""
        return self._add_effect(lib.sinew_character_add_wind, _WIND, joints, settings)

    def add_buoyancy(self, joints=None, **settings):
        return self._add_effect(lib.sinew_character_add_buoyancy, _BUOYANCY, joints, settings)

    def add_force_field(self, joints=None, **settings):
        return self._add_effect(lib.sinew_character_add_force_field, _FORCE_FIELD, joints, settings)

    def add_joint_spring(self, joints=None, **settings):
        return self._add_effect(lib.sinew_character_add_joint_spring, _JOINT_SPRING, joints, settings)

    def remove_effects(self):
        self._call(lib.sinew_character_remove_effects)

    def add_graph(self, graph, below=None, **settings):
        """It follows the graph from now on. `below`(point) answers None, or the height of the ground or its point, normal and body
        (m, world)."""
        struct = _settings(_abi.GraphSettings, lib.sinew_graph_settings_init, settings)
        if below:
            def ask(_, point, hit):
                found = below(tuple((ctypes.c_float * 3).from_address(point)))
                if found is None:
                    return 0
                answer = _abi.GroundHit.from_address(hit)
                if isinstance(found, (int, float)):
                    answer.point[2] = found
                else:
                    answer.point[:], answer.normal[:], answer.body = found
                return 1

            struct.ground, struct.below = _abi.GroundKind.HOST, _abi.GroundBelow(ask)
            self.world._native.kept.append(struct.below)
        self._call(lib.sinew_character_add_graph, graph.handle, byref(struct))

    def play_graph(self, h):
        """What its graph wants h seconds later is wanted at the end of the next step."""
        self._call(lib.sinew_character_play_graph, h)

    def sample_graph(self, h, jets):
        """The same, into `jets` instead."""
        self._call(lib.sinew_character_sample_graph, h, _pointer(jets), len(jets))
        return jets

    def set_parameter(self, parameter, value):
        """Of its graph, by number or name."""
        if isinstance(parameter, str):
            self._call(lib.sinew_character_set_parameter_by_name, parameter.encode(), value)
        else:
            self._call(lib.sinew_character_set_parameter, parameter, value)

    def trigger(self, parameter):
        """Asks its graph for something once, by number or name."""
        if isinstance(parameter, str):
            self._call(lib.sinew_character_trigger_by_name, parameter.encode())
        else:
            self._call(lib.sinew_character_trigger, parameter)

    def _get(self, kind, get, *arguments):
        out = kind()
        self._call(get, *arguments, byref(out))
        return out

    def parameter(self, index):
        return self._get(_abi.ParameterValue, lib.sinew_character_get_parameter, index)

    def machine(self, node):
        """Which state a machine of its graph is in."""
        report = _abi.MachineReport(size=ctypes.sizeof(_abi.MachineReport))
        self._call(lib.sinew_character_get_machine, node, byref(report))
        return report

    @property
    def graph_place(self):
        """Where root motion has brought it."""
        return self._get(_abi.GraphPlace, lib.sinew_character_get_graph_place)

    def put_graph(self, x, y, heading):
        self._call(lib.sinew_character_put_graph, (ctypes.c_double * 2)(x, y), heading)

    def set_grounds(self, jets):
        """The bodies that `below` of add_graph tells of."""
        self._call(lib.sinew_character_set_grounds, _pointer(jets), len(jets))

    def graph_events(self, most=64):
        """What happened in its clips in the last frame."""
        out, count = (_abi.GraphEvent * most)(), ctypes.c_int32()
        self._call(lib.sinew_character_get_graph_events, byref(out), most, byref(count), None)
        return out[:count.value]

    def graph_curves(self, most=256):
        """[Asset.find_curve] as of the last frame."""
        out, count = (_abi.CurveValue * most)(), ctypes.c_int32()
        self._call(lib.sinew_character_get_graph_curves, byref(out), most, byref(count))
        return out[:count.value]

    def save_graph(self):
        return _saved(lib.sinew_character_save_graph, self.handle)

    def restore_graph(self, saved):
        self._call(lib.sinew_character_restore_graph, bytes(saved), len(saved))

    @property
    def report(self):
        return _report(_abi.CharacterReport, lib.sinew_character_get_report, self.handle)

    def _view(self, kind, ctype):
        view = _abi.View()
        self._call(lib.sinew_character_get_view, kind, byref(view))
        memory = (ctype * (view.count * view.stride // ctypes.sizeof(ctype))).from_address(view.data)
        memory.owner = self.world._native
        return memory, view.count

    def _transforms(self, kind):
        memory, count = self._view(kind, ctypes.c_float)
        return _floats(memory, count, 8, 7)

    def _by_dof(self, kind):
        memory, count = self._view(kind, ctypes.c_float)
        return _floats(memory, count, 1, 1)

    @property
    def model(self):
        """[joint] rotation x y z w, translation: joint to world."""
        return self._transforms(_abi.ViewKind.MODEL)

    @property
    def local(self):
        """[joint] rotation x y z w, translation: joint to parent."""
        return self._transforms(_abi.ViewKind.LOCAL)

    @property
    def torque(self):
        return self._by_dof(_abi.ViewKind.TORQUE)

    @property
    def load(self):
        return self._by_dof(_abi.ViewKind.LOAD)

    @property
    def limit(self):
        return self._by_dof(_abi.ViewKind.LIMIT)

    @property
    def unknown(self):
        memory, _ = self._view(_abi.ViewKind.UNKNOWN, ctypes.c_uint8)
        return memoryview(memory) if numpy is None else numpy.frombuffer(memory, numpy.uint8)


class Prop(_InWorld):
    def add_wind(self, **settings):
        return self._add_effect(lib.sinew_prop_add_wind, _WIND, None, settings)

    def add_buoyancy(self, **settings):
        return self._add_effect(lib.sinew_prop_add_buoyancy, _BUOYANCY, None, settings)

    def add_force_field(self, **settings):
        return self._add_effect(lib.sinew_prop_add_force_field, _FORCE_FIELD, None, settings)

    @property
    def state(self):
        """Rotation x y z w, translation, velocity."""
        pose, velocity = _abi.Transform(), (ctypes.c_float * 3)()
        self._call(lib.sinew_prop_get_state, byref(pose), byref(velocity))
        return tuple(pose.rotation), tuple(pose.translation), tuple(velocity)

    def set_state(self, translation, rotation=(0, 0, 0, 1), velocity=(0, 0, 0), angular_velocity=(0, 0, 0)):
        pose = _set(_abi.Transform(), {"rotation": rotation, "translation": translation})
        self._call(lib.sinew_prop_set_state, byref(pose), (ctypes.c_float * 3)(*velocity),
                   (ctypes.c_float * 3)(*angular_velocity))

    def park(self):
        self._call(lib.sinew_prop_park)

    @property
    def report(self):
        return _report(_abi.CharacterReport, lib.sinew_prop_get_report, self.handle)


class Loop(_InWorld):
    def set_closed(self, closed):
        self._call(lib.sinew_loop_set_closed, closed)

    @property
    def state(self):
        """How far it is apart (m), and the force on side a (N)."""
        gap, force = ctypes.c_double(), (ctypes.c_float * 3)()
        self._call(lib.sinew_loop_get_state, byref(gap), byref(force))
        return gap.value, tuple(force)


class Particles(_InWorld):
    """A strand, cloth or soft tissue."""

    @property
    def nodes(self):
        """Where they are (m, world), and how fast (m/s): a copy."""
        count = ctypes.c_int32()
        status = lib.sinew_particles_get_nodes(self.handle, None, 0, byref(count))
        if status not in (Status.OK, Status.TOO_SMALL):
            raise Error(status)
        out = (_abi.Particle * count.value)()
        self._call(lib.sinew_particles_get_nodes, byref(out), count.value, byref(count))
        return out[:]

    def reset(self, velocity=(0, 0, 0)):
        self._call(lib.sinew_particles_reset, (ctypes.c_float * 3)(*velocity))

    @property
    def report(self):
        return _report(_abi.CharacterReport, lib.sinew_particles_get_report, self.handle)
