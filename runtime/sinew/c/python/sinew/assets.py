"""Assets, graphs, and jobs on poses."""
import ctypes
import os
from ctypes import byref

from . import _abi
from ._abi import BlendMode, Status
from ._core import check, Described, Error, floats, jets_for, lib, pointer, report_of, settings_of


class Layer:
    """One of the motions that Asset.blend mixes: jets, weight (a number, or value, rate and acceleration: ease()), mode, mask."""

    def __init__(self, jets, weight=1.0, mode=BlendMode.MIX, mask=None):
        self.jets, self.mode = jets, mode
        self.weight = (weight, 0.0, 0.0) if isinstance(weight, (int, float)) else tuple(weight)
        self.mask = None if mask is None else (ctypes.c_float * len(mask))(*mask)

    def _write(self, layer, count):
        if len(self.jets) < count or self.mask is not None and len(self.mask) < count:
            raise TypeError("a layer with fewer joints than are blended")
        layer.jets, layer.mode = pointer(self.jets), self.mode
        layer.mask = None if self.mask is None else ctypes.addressof(self.mask)
        layer.weight, layer.weight_rate, layer.weight_acceleration = self.weight


def ease(elapsed, duration):
    """A weight from 0 to 1, with its rate and acceleration."""
    out = (ctypes.c_float * 3)()
    check(lib.sinew_ease(elapsed, duration, byref(out)))
    return tuple(out)


def smooth(state, goal, half_life, step):
    """Moves `state` (CurveValue: value, rate, acceleration) `step` s on towards a goal that steps."""
    check(lib.sinew_smooth(byref(state), goal, half_life, step))
    return state


def place_jets(jets, translation=(0, 0, 0), rotation=(0, 0, 0, 1)):
    """Moves a pose: what a clip shows at the origin is shown there."""
    place = _abi.Pose(tuple(rotation), tuple(translation))
    check(lib.sinew_place_jets(byref(place), pointer(jets), len(jets)))
    return jets


def split_root(jets):
    """The root of `jets` as two jets of one each: its way over the ground, and what stays in the body."""
    travel, body = jets_for(1), jets_for(1)
    check(lib.sinew_split_root(pointer(jets), pointer(travel), pointer(body)))
    return travel, body


class Look:
    """What a character's look remembers: `state`, a struct that may be copied."""

    def __init__(self):
        self.state = _abi.LookState()

    def __call__(self, asset, jets, target, step, **settings):
        """Turns spine, neck and head of `jets` to the target (m, model space), `step` s after the last call."""
        struct = settings_of(_abi.Look, lib.sinew_look_init, {"target": target, "step": step, **settings})
        check(lib.sinew_asset_look(asset.handle, byref(struct), byref(self.state), pointer(jets), len(jets)))


def ground_hit(point, normal=(0, 0, 1), body=-1):
    """What a ray met of the ground (m, model space), for Foot."""
    return _abi.GroundHit(tuple(point), tuple(normal), body)


class Foot:
    """What is known of a foot in a frame: its contact (0 to 1, that it rests), and the hits under it and ahead of it."""

    def __init__(self, contact, under=(), ahead=()):
        self.contact = contact
        self.under, self.ahead = ((_abi.GroundHit * len(hits))(*hits) for hits in (under, ahead))

    def _write(self, foot):
        foot.under, foot.under_count = ctypes.addressof(self.under), len(self.under)
        foot.ahead, foot.ahead_count = ctypes.addressof(self.ahead), len(self.ahead)
        foot.contact = self.contact


class Feet:
    """What a character's feet remember: `state`, a struct that may be copied."""

    def __init__(self):
        self.state = _abi.FeetState()

    def __call__(self, asset, jets, left, right, step, grounds=None, **settings):
        """Puts the feet of `jets` on the ground that `left` and `right`, each a Foot, tell of, `step` s after the last call.
        `grounds`: jets of the bodies that hits name, body to model space."""
        struct = settings_of(_abi.Feet, lib.sinew_feet_init, {"step": step, **settings})
        feet = (_abi.Foot * 2)()
        left._write(feet[0])
        right._write(feet[1])
        address, count = (None, 0) if grounds is None else (pointer(grounds), len(grounds))
        check(lib.sinew_asset_place_feet(asset.handle, byref(struct), byref(feet), address, count, byref(self.state),
                                         pointer(jets), len(jets)))


class Transition:
    """From what a character does (`now`, jets) to another motion (`next`) within `duration` s. `state` may be copied."""

    def __init__(self, asset, now, next, duration):
        arguments = (asset.handle, pointer(now), len(now), pointer(next), len(next), duration)
        count = ctypes.c_int32()
        status = lib.sinew_asset_begin_transition(*arguments, None, 0, byref(count))
        if status != Status.TOO_SMALL:
            raise Error(status)
        self.state = (ctypes.c_float * count.value)()
        check(lib.sinew_asset_begin_transition(*arguments, self.state, count.value, byref(count)))

    def __call__(self, asset, jets, step):
        """Adds to `jets`, of the new motion, what is left, `step` s after the last call; 0 in the frame of the switch."""
        check(lib.sinew_asset_play_transition(asset.handle, self.state, len(self.state), step, pointer(jets), len(jets)))


class Asset(Described):
    """A skeleton and its clips, from a path or from the bytes of a file."""

    def __init__(self, source):
        out = ctypes.c_uint64()
        if isinstance(source, (bytes, bytearray)):
            check(lib.sinew_asset_read(bytes(source), len(source), byref(out)))
        else:
            check(lib.sinew_asset_load(os.fsencode(source), byref(out)))
        super().__init__(out.value, lib.sinew_asset_destroy)
        self.info = report_of(_abi.AssetInfo, lib.sinew_asset_get_info, self.handle)

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
        check(lib.sinew_asset_blend(self.handle, byref(structs), len(layers), pointer(jets), len(jets)))
        return jets

    def subtract(self, jets, reference=None):
        """Makes `jets` the difference from a pose, or from rest, as additive layers are."""
        address, count = (None, 0) if reference is None else (pointer(reference), len(reference))
        check(lib.sinew_asset_subtract(self.handle, address, count, pointer(jets), len(jets)))

    def subtract_in_model(self, jets, reference=None):
        """Makes `jets` the turn from a pose, or from rest, in model space, for add_in_model."""
        reference = self.blend([], jets_for(len(jets))) if reference is None else reference
        scratch = jets_for(2 * len(jets))
        check(lib.sinew_asset_subtract_in_model(self.handle, pointer(reference), len(reference), pointer(jets), len(jets),
                                                pointer(scratch), len(scratch)))

    def add_in_model(self, jets, difference, weight=1.0, mask=None):
        """Adds to `jets` what subtract_in_model made; it does not lean with the body below."""
        struct, scratch = _abi.BlendLayer(), jets_for(2 * len(jets))
        layer = Layer(difference, weight, BlendMode.ADDITIVE, mask)
        layer._write(struct, len(jets))
        check(lib.sinew_asset_add_in_model(self.handle, byref(struct), pointer(jets), len(jets), pointer(scratch), len(scratch)))

    def leg(self, foot):
        """Joints and sole of the leg of Role.FOOT_L or Role.FOOT_R."""
        return self._element(_abi.LegInfo, lib.sinew_asset_get_leg, foot)

    def partner(self, joint):
        """The joint on the other side; -1: none."""
        return self._find(lib.sinew_asset_get_partner, joint)

    def mirror(self, jets):
        """Exchanges left and right."""
        check(lib.sinew_asset_mirror(self.handle, pointer(jets), len(jets)))

    def two_bone(self, jets, upper, middle, end, target, **settings):
        """Turns two joints of a limb so that its end comes to the target (m, model space)."""
        struct = settings_of(_abi.TwoBone, lib.sinew_two_bone_init,
                           {"upper": upper, "middle": middle, "end": end, "target": target, **settings})
        check(lib.sinew_asset_two_bone(self.handle, byref(struct), pointer(jets), len(jets)))

    def aim(self, jets, joint, target, **settings):
        """Turns a joint so that its axis points to the target (m, model space)."""
        struct = settings_of(_abi.Aim, lib.sinew_aim_init, {"joint": joint, "target": target, **settings})
        check(lib.sinew_asset_aim(self.handle, byref(struct), pointer(jets), len(jets)))

    def model(self, jets):
        """[joint] rotation x y z w, translation: joint to model."""
        out, count = (_abi.Transform * len(jets))(), ctypes.c_int32()
        check(lib.sinew_asset_get_model(self.handle, pointer(jets), len(jets), byref(out), len(jets), byref(count)))
        return floats(out, count.value, 8, 7)

    def socket(self, jets, joint, translation=None, rotation=(0, 0, 0, 1)):
        """Motion in model space, one jet, of a frame that is fixed to a joint."""
        out = jets_for(1)
        offset = None if translation is None else byref(_abi.Transform(tuple(rotation), tuple(translation)))
        check(lib.sinew_asset_get_socket(self.handle, pointer(jets), len(jets), joint, offset, pointer(out)))
        return out

    def passed_events(self, clip, before, now, most=64, **settings):
        """What a clip passed from one time to another (s)."""
        struct = settings_of(_abi.ClipPassage, lib.sinew_clip_passage_init, {"clip": clip, "before": before, "now": now, **settings})
        out, count = (_abi.GraphEvent * most)(), ctypes.c_int32()
        check(lib.sinew_asset_get_passed_events(self.handle, byref(struct), byref(out), most, byref(count)))
        return out[:count.value]

    def ended_events(self, clip, time, backwards=False, most=64):
        """What a clip is in the middle of when it stops being played there."""
        out, count = (_abi.GraphEvent * most)(), ctypes.c_int32()
        check(lib.sinew_asset_get_ended_events(self.handle, clip, time, backwards, byref(out), most, byref(count)))
        return out[:count.value]

    def curves(self, clip, time, rate=1.0, rate_change=0.0):
        """[find_curve] at a time (s) of a clip."""
        most = self.info.curves
        out, count = (_abi.CurveValue * most)(), ctypes.c_int32()
        check(lib.sinew_asset_sample_curves(self.handle, clip, time, rate, rate_change, byref(out), most, byref(count)))
        return list(out)

    def in_contact(self, clip, time, joint):
        """Whether a joint rests on the ground at a time (s) of a clip."""
        return bool(self._find(lib.sinew_clip_in_contact, clip, time, joint))

    def sample(self, clip, time, rate=1.0, rate_change=0.0, jets=None):
        """Jets of all joints, into `jets` where given."""
        jets = jets_for(self.info.joints) if jets is None else jets
        check(lib.sinew_clip_sample(self.handle, clip, time, rate, rate_change, pointer(jets), len(jets)))
        return jets


class Graph(Described):
    """What may be done with an asset's clips (`sinew graph compile`), from a path or from the bytes of a file."""

    def __init__(self, source, asset):
        out = ctypes.c_uint64()
        if isinstance(source, (bytes, bytearray)):
            check(lib.sinew_graph_read(bytes(source), len(source), asset.handle, byref(out)))
        else:
            check(lib.sinew_graph_load(os.fsencode(source), asset.handle, byref(out)))
        super().__init__(out.value, lib.sinew_graph_destroy)
        self.info = report_of(_abi.GraphInfo, lib.sinew_graph_get_info, self.handle)

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
