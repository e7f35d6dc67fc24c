"""What is in a world: characters, props, loops, particles, and effects on them."""
import ctypes
from ctypes import byref

from . import _abi
from ._abi import BodyKind, Level, Status
from ._core import check, Error, floats, InWorld, lib, numpy, pointer, report_of, saved, set_fields, settings_of, three


def _effect(kind, init, joints, values):
    struct = settings_of(kind, init, values)
    if joints is not None:
        numbers = (ctypes.c_int32 * len(joints))(*joints)
        struct.joints, struct.joint_count = ctypes.addressof(numbers), len(joints)
        struct.keep = numbers
    return struct


class Effect(InWorld):
    """What acts on a character or prop."""

    def __init__(self, world, handle, kind, init, change):
        super().__init__(world, handle)
        self._kind, self._init, self._change = kind, init, change

    def set(self, **settings):
        """From the next step on; what is not named has its default."""
        self._call(self._change, byref(settings_of(self._kind, self._init, settings)))

    def remove(self):
        self._call(lib.sinew_effect_remove)


_WIND = (_abi.Wind, lib.sinew_wind_init, lib.sinew_effect_set_wind)
_BUOYANCY = (_abi.Buoyancy, lib.sinew_buoyancy_init, lib.sinew_effect_set_buoyancy)
_FORCE_FIELD = (_abi.ForceField, lib.sinew_force_field_init, lib.sinew_effect_set_force_field)
_JOINT_SPRING = (_abi.JointSpring, lib.sinew_joint_spring_init, lib.sinew_effect_set_joint_spring)


class _Affected(InWorld):
    """What effects may act on."""

    def _add_effect(self, add, effect, joints, settings):
        struct, out = _effect(*effect[:2], joints, settings), ctypes.c_uint64()
        self._call(add, byref(struct), byref(out))
        return Effect(self.world, out.value, *effect)


class Character(_Affected):
    def play(self, asset, clip, time, rate=1.0, rate_change=0.0):
        """What a clip shows then is wanted at the end of the next step."""
        play = _abi.Play(self.handle, asset.handle, clip, 0, time, rate, rate_change)
        check(lib.sinew_play_clips(byref(play), 1))

    def set_target(self, jets):
        self._call(lib.sinew_character_set_target, pointer(jets), len(jets))

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

    def set_activation(self, activation):
        """How much of their strength muscles are given at the moment: [joint] 0 to 1."""
        count = len(activation)
        self._call(lib.sinew_character_set_activation, (ctypes.c_float * count)(*activation), count)

    def set_self_collision(self, collision):
        """Whether limbs meet each other from now on (SelfCollision)."""
        self._call(lib.sinew_character_set_self_collision, collision)

    @property
    def strength(self):
        """Of all muscles."""
        return self._get(ctypes.c_float, lib.sinew_character_get_strength).value

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
    def detail(self):
        """significance, most, check_every and bake, as set_detail takes them."""
        out = (ctypes.c_double(), ctypes.c_int32(), ctypes.c_int32(), ctypes.c_int32())
        self._call(lib.sinew_character_get_detail, *map(byref, out))
        return out[0].value, Level(out[1].value), out[2].value, bool(out[3].value)

    @property
    def displacement(self):
        """x, y (m), yaw (rad)."""
        out = (ctypes.c_double * 3)()
        self._call(lib.sinew_character_get_displacement, byref(out))
        return tuple(out)

    def take_displacement(self):
        self._call(lib.sinew_character_take_displacement)

    @property
    def rise(self):
        """m, by which its animation is displaced upwards."""
        out = ctypes.c_double()
        self._call(lib.sinew_character_get_rise, byref(out))
        return out.value

    def displace(self, x, y, yaw):
        self._call(lib.sinew_character_displace, three((x, y, yaw)))

    def raise_by(self, further):
        self._call(lib.sinew_character_raise, further)

    def ride(self, x, y, yaw, z=0.0):
        """Before a step, of an animation that what it stands on takes along by so much in it (m, rad)."""
        self._call(lib.sinew_character_ride, (ctypes.c_double * 4)(x, y, yaw, z))

    def come_back(self):
        """A grounded root that moves nearly as its animation wants it is led back onto it."""
        self._call(lib.sinew_character_come_back)

    def give_hand(self):
        """In the next step a free root may be given, besides its help, what its target asks of no floor at all."""
        self._call(lib.sinew_character_give_hand)

    def keep_out(self, most):
        """The target of the next step is a plan: of it `most` m may lie in what is around, of a clip 3 cm."""
        self._call(lib.sinew_character_keep_out, most)

    @property
    def ground(self):
        """What bears it: force (N, up), place (m), velocity (m/s) and turn rate (rad/s) of that."""
        force, place, velocity, turn = ctypes.c_double(), (ctypes.c_double * 3)(), (ctypes.c_double * 3)(), ctypes.c_double()
        self._call(lib.sinew_character_get_ground, byref(force), place, velocity, byref(turn))
        return force.value, tuple(place), tuple(velocity), turn.value

    def apply_impulse(self, joint, point, impulse):
        self._call(lib.sinew_character_apply_impulse, joint, three(point), three(impulse))

    def apply_force(self, joint, point, force):
        self._call(lib.sinew_character_apply_force, joint, three(point), three(force))

    def park(self, parked=True):
        self._call(lib.sinew_character_park, parked)

    @property
    def parked(self):
        return bool(self._get(ctypes.c_int32, lib.sinew_character_get_parked).value)

    def add_behaviour(self, **settings):
        self._call(lib.sinew_character_add_behaviour,
                   byref(settings_of(_abi.BehaviourSettings, lib.sinew_behaviour_settings_init, settings)))

    def use_get_ups(self, asset):
        """The clips by which it gets up: those of the asset named get_up... and roll..."""
        self._call(lib.sinew_character_use_get_ups, asset.handle)

    def balance(self, jets, h):
        """Changes `jets` where the behaviour acts, and makes them the target."""
        self._call(lib.sinew_character_balance, pointer(jets), len(jets), h)

    def order(self, order):
        self._call(lib.sinew_character_order, order)

    @property
    def behaviour(self):
        return report_of(_abi.BehaviourReport, lib.sinew_character_get_behaviour, self.handle)

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
        struct = settings_of(_abi.GraphSettings, lib.sinew_graph_settings_init, settings)
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
        self._call(lib.sinew_character_sample_graph, h, pointer(jets), len(jets))
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
        self._call(lib.sinew_character_set_grounds, pointer(jets), len(jets))

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

    def save_behaviour(self):
        return saved(lib.sinew_character_save_behaviour, self.handle)

    def restore_behaviour(self, saved):
        self._call(lib.sinew_character_restore_behaviour, bytes(saved), len(saved))

    def save_graph(self):
        return saved(lib.sinew_character_save_graph, self.handle)

    def restore_graph(self, saved):
        self._call(lib.sinew_character_restore_graph, bytes(saved), len(saved))

    @property
    def report(self):
        return report_of(_abi.CharacterReport, lib.sinew_character_get_report, self.handle)

    @property
    def physics(self):
        """How it stands and what its muscles bear: tilt, face_up, height, load, off_animation, contacts, contact_force."""
        return report_of(_abi.Physics, lib.sinew_character_get_physics, self.handle)

    def _view(self, kind, ctype):
        view = _abi.View()
        self._call(lib.sinew_character_get_view, kind, byref(view))
        memory = (ctype * (view.count * view.stride // ctypes.sizeof(ctype))).from_address(view.data)
        memory.owner = self.world._native
        return memory, view.count

    def _transforms(self, kind):
        memory, count = self._view(kind, ctypes.c_float)
        return floats(memory, count, 8, 7)

    def _by_dof(self, kind):
        memory, count = self._view(kind, ctypes.c_float)
        return floats(memory, count, 1, 1)

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


class Prop(_Affected):
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
        pose = set_fields(_abi.Transform(), {"rotation": rotation, "translation": translation})
        self._call(lib.sinew_prop_set_state, byref(pose), (ctypes.c_float * 3)(*velocity),
                   (ctypes.c_float * 3)(*angular_velocity))

    def park(self):
        self._call(lib.sinew_prop_park)

    @property
    def report(self):
        return report_of(_abi.CharacterReport, lib.sinew_prop_get_report, self.handle)


class Loop(InWorld):
    def set_closed(self, closed):
        self._call(lib.sinew_loop_set_closed, closed)

    @property
    def state(self):
        """How far it is apart (m), and the force on side a (N)."""
        gap, force = ctypes.c_double(), (ctypes.c_float * 3)()
        self._call(lib.sinew_loop_get_state, byref(gap), byref(force))
        return gap.value, tuple(force)


class Particles(InWorld):
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
        return report_of(_abi.CharacterReport, lib.sinew_particles_get_report, self.handle)


_BODIES = sum(1 << kind for kind in (BodyKind.CHARACTER, BodyKind.PROP, BodyKind.PARTICLES))


class Sensor(InWorld):
    def __init__(self, world, handle, room):
        super().__init__(world, handle)
        self.room, self.left_out = room, 0

    def _query(self, at, radius, settings):
        return settings_of(_abi.Query, lib.sinew_query_init, {"origin": at, "radius": radius, "kinds": _BODIES, **settings})

    def move(self, at, radius, **settings):
        """Elsewhere, of another size or for others."""
        self._call(lib.sinew_sensor_place, byref(self._query(at, radius, settings)))

    def update(self):
        """Looks who is in it: those who left, then those who came. `left_out` says how many found no room."""
        left_out, count = ctypes.c_int32(), ctypes.c_int32()
        self._call(lib.sinew_sensor_update, byref(left_out))
        self.left_out = left_out.value
        out = (_abi.SensorEvent * (2 * self.room))()
        self._call(lib.sinew_sensor_get_events, byref(out), 2 * self.room, byref(count))
        return out[:count.value]

    @property
    def bodies(self):
        """Who is in it since the last update."""
        out, count = (_abi.Body * self.room)(), ctypes.c_int32()
        self._call(lib.sinew_sensor_get_bodies, byref(out), self.room, byref(count))
        return out[:count.value]
