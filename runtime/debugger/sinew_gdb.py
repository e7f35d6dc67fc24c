"""Shows Sinew's types in gdb in one line each: vectors, rotations, transforms, motions, statuses and handles.

    (gdb) source /usr/share/sinew/sinew_gdb.py
    (gdb) print jets[3]
    $1 = at (0.1, 0, 0.4), turned 30 deg about (0, 0, 1) = {omega = (0, 0, 1.5), ...

In ~/.gdbinit the first line does it for all programs. `print/r` shows members as they are; `disable pretty-printer global
sinew` switches all of this off. What is printed is ASCII: a terminal need not know UTF-8.
"""

import math

import gdb
import gdb.printing


def text_of(number):
    """Six digits, and no minus before a zero."""
    return "%.6g" % (number + 0.0 if number != 0 else 0.0)


def tuple_of(numbers):
    return "(" + ", ".join(text_of(n) for n in numbers) + ")"


def is_moving(scalar):
    """Whether it is a TimeJet and not a number."""
    return scalar.type.strip_typedefs().code == gdb.TYPE_CODE_STRUCT


def number_of(scalar, part="value"):
    return float(scalar[part] if is_moving(scalar) else scalar)


def elements(matrix):
    """Of an Eigen matrix of fixed size, column by column."""
    array = matrix["m_storage"]["m_data"]["array"]
    first, last = array.type.strip_typedefs().range()
    return [array[i] for i in range(first, last + 1)]


def numbers(matrix):
    return [number_of(e) for e in elements(matrix)]


def rates(scalars):
    """What moving numbers are shown with, besides their values."""
    if not is_moving(scalars[0]):
        return ""
    return "".join(", %s %s" % (part, tuple_of([number_of(s, part) for s in scalars]))
                   for part in ("rate", "acceleration"))


def turn_of(quaternion):
    """Angle and axis, the shorter way round; or what is wrong with it."""
    x, y, z, w = numbers(quaternion["m_coeffs"])
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not math.isfinite(length):
        return "a rotation that is not finite"
    if abs(length - 1) > 1e-3:
        return "a rotation of length " + text_of(length)
    if w < 0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    if sine < 1e-7:
        return "no turn"
    angle = math.degrees(2 * math.atan2(sine, w))
    return "%s deg about %s" % (text_of(angle), tuple_of((x / sine, y / sine, z / sine)))


def place_of(pose):
    """Of a transform, a jet or a moving frame."""
    rotation = pose["rotation"]
    moving = any(field.name == "omega" for field in rotation.type.fields())
    turn = turn_of(rotation["value"] if moving else rotation)
    turn = "not turned" if turn == "no turn" else "turned " + turn if "about" in turn else turn
    return "at %s, %s" % (tuple_of(numbers(pose["translation"])), turn)


def enumerator(value):
    """Its name without its scope."""
    return str(value).split("::")[-1]


class Shown:
    """A value shown by the words of a function, and by those of its members that the words leave out."""

    def __init__(self, value, words, members):
        self.value, self.words, self.members = value, words, members

    def to_string(self):
        return self.words(self.value)

    def children(self):
        return [(name, self.value[name]) for name in self.members]


def vector(v):
    return tuple_of(numbers(v)) + rates(elements(v))


def matrix(m):
    columns = numbers(m)
    return "[" + ", ".join(tuple_of(columns[row::3]) for row in range(3)) + "]"


def rotation(q):
    return "%s, xyzw %s" % (turn_of(q), vector(q["m_coeffs"]))


def moving_rotation(r):
    return rotation(r["value"])


def time_jet(t):
    return "%s, rate %s, acceleration %s" % tuple(text_of(float(t[p])) for p in ("value", "rate", "acceleration"))


def status(s):
    if enumerator(s["code"]) == "kOk":
        return "ok"
    index = int(s["index"])
    return enumerator(s["code"]) + (" at %d" % index if index >= 0 else "") + ": " + s["reason"].string()


def character(c):
    if int(c["state_"]) == 0:
        return "null"
    try:
        state = c["state_"].dereference()
        report = state["report"]
        return "%s, root at %s, %d of %d degrees of freedom unknown" % (
            enumerator(report["level"]), vector(state["history"]["place"]), int(report["unknown_dofs"]),
            int(report["dofs"]))
    except gdb.error:  # the runtime was built without debug information
        return "at 0x%x" % int(c["state_"])


def effect_id(e):
    return "none" if int(e["serial"]) == 0 else "slot %d, serial %d" % (int(e["slot"]), int(e["serial"]))


def body_ref(b):
    kind = enumerator(b["kind"])
    if kind == "kGround":
        return kind
    joint = ", joint %d" % int(b["joint"]) if kind in ("kCharacter", "kParticles") else ""
    return "%s %d%s" % (kind, int(b["index"]), joint)


def displacement(d):
    return "by %s, turned %s deg" % (tuple_of(tuple(float(d[k]) for k in "xyz")), text_of(math.degrees(float(d["yaw"]))))


SCALAR = r"(float|double|sinew::TimeJet<(float|double)>)"
TYPES = [  # name, of which types, in which words, with which members besides
    ("Vec3", r"^Eigen::Matrix<%s, 3, 1, 0, 3, 1>$" % SCALAR, vector, ()),
    ("Mat3", r"^Eigen::Matrix<(float|double), 3, 3, 0, 3, 3>$", matrix, ()),
    ("Quat", r"^Eigen::Quaternion<%s, 0>$" % SCALAR, rotation, ()),
    ("Transform", r"^sinew::Transform<(float|double)>$", place_of, ("rotation", "translation")),
    ("MovingTransform", r"^sinew::MovingTransform<(float|double)>$", place_of, ("rotation", "translation")),
    ("MovingRotation", r"^sinew::MovingRotation<(float|double)>$", moving_rotation, ("omega", "alpha")),
    ("JointJet", r"^sinew::JointJet<(float|double)>$", place_of, ("omega", "alpha", "velocity", "acceleration")),
    ("TimeJet", r"^sinew::TimeJet<(float|double)>$", time_jet, ()),
    ("Status", r"^sinew::Status$", status, ()),
    ("Character", r"^sinew::Character<(float|double)>$", character, ()),
    ("EffectId", r"^sinew::EffectId$", effect_id, ()),
    ("BodyRef", r"^sinew::BodyRef$", body_ref, ()),
    ("Displacement", r"^sinew::Displacement$", displacement, ()),
]

printers = gdb.printing.RegexpCollectionPrettyPrinter("sinew")
for name, types, words, members in TYPES:
    printers.add_printer(name, types, lambda value, words=words, members=members: Shown(value, words, members))
gdb.printing.register_pretty_printer(None, printers, replace=True)
