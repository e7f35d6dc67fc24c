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
from ._abi import (AnchorKind, BehaviourEventKind, BehaviourOrder, BehaviourReason, BehaviourState, BlendMode, BodyKind, ContactPhase, CurveValue,
                   EventKind, FootHold, GetUpPolicy, GroundKind, JointType, Level, LogLevel, LoopKind, NodeType, ParameterType, Role, RootDrive,
                   SelfCollision, Shape, SnapshotPart, Status, Tone)
from ._core import Error, check, jets_for, lib
from .assets import (Asset, Feet, Foot, Graph, Layer, Look, Transition, ease, ground_hit, place_jets, smooth, split_root)
from .hooks import set_log
from .members import Character, Effect, Loop, Particles, Prop, Sensor
from .world import Crowd, Plays, World

__version__ = lib.sinew_version().decode()
