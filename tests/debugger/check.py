"""Run by gdb: stops in values.cpp and compares how its variables are shown with what is written here.

Of the Visual Studio file, whose debugger is not here, the expressions are evaluated by gdb: members that it names exist,
and its words come out as they should. SINEW_NATVIS says where that file is. Ends gdb with 0, with 1 where anything differs,
with 77 where programs may not be run.
"""

import os
import re
import sys
import traceback
import xml.etree.ElementTree as xml

import gdb

QUARTER = "xyzw (0, 0, 0.707107, 0.707107)"
EXPECTED = {  # variable: by gdb; by Visual Studio, where that differs
    "vector": ("(1, -2.5, 0)",),
    "vector_of_doubles": ("(0.1, 1e-09, 0)",),
    "matrix": ("[(1, 2, 3), (4, 5, 6), (7, 8, 9)]",),
    "rotation": ("90 deg about (0, 0, 1), " + QUARTER, QUARTER),
    "other_side": ("120 deg about (-0.57735, -0.57735, -0.57735), xyzw (0.5, 0.5, 0.5, -0.5)", "xyzw (0.5, 0.5, 0.5, -0.5)"),
    "none": ("no turn, xyzw (0, 0, 0, 1)", "xyzw (0, 0, 0, 1)"),
    "too_long": ("a rotation of length 2, xyzw (0, 0, 0, 2)", "xyzw (0, 0, 0, 2)"),
    "broken": ("a rotation that is not finite, xyzw (0, 0, 0, nan)", "xyzw (0, 0, 0, nan)"),
    "transform": ("at (1, -2.5, 0), turned 90 deg about (0, 0, 1) = {rotation = 90 deg about (0, 0, 1), %s, "
                  "translation = (1, -2.5, 0)}" % QUARTER, "at (1, -2.5, 0), turned " + QUARTER),
    "jet": ("at (3, 2, 1), not turned = {omega = (0, 0, 1.5), alpha = (0, 0, 0), velocity = (0, 0, 0), "
            "acceleration = (0, 0, 0)}", "at (3, 2, 1), turned xyzw (0, 0, 0, 1)"),
    "weight": ("0.5, rate 2, acceleration -4",),
    "moving": ("(0.5, 1, 2), rate (2, 0, 0), acceleration (-4, 0, 0)",
               "(0.5, rate 2, acceleration -4, 1, rate 0, acceleration 0, 2, rate 0, acceleration 0)"),
    "moving_frame": ("at (3, 2, 1), not turned = {rotation = no turn, xyzw (0, 0, 0, 1) = {omega = (0, 0, 1.5), "
                     "alpha = (0, 0, 0)}, translation = (3, 2, 1), rate (0, 0, 0), acceleration (0, 0, 0)}",
                     "at (3, rate 0, acceleration 0, 2, rate 0, acceleration 0, 1, rate 0, acceleration 0), "
                     "turned xyzw (0, 0, 0, 1)"),
    "ok": ("ok",),
    "refused": ("kNotFinite at 3: target is not finite",),
    "unread": ("kIo: no such file",),
    "hero": ("kChecked, root at (0, 0, 0), 0 of 6 degrees of freedom unknown",),
    "nobody": ("null",),
    "no_effect": ("none",),
    "effect": ("slot 2, serial 7",),
    "ground": ("kGround",),
    "wall": ("kObstacle 3",),
    "hand": ("kCharacter 1, joint 9",),
    "displacement": ("by (1, 2, 0), turned 28.6479 deg", "by (1, 2, 0), turned 0.5 rad"),
}


class Natvis:
    """As much of natvis as the file needs: names with *, conditions, {expression,format}, items."""

    def __init__(self, path):
        space = "{http://schemas.microsoft.com/vstudio/debugger/natvis/2010}"
        self.types = []
        for entry in xml.parse(path).getroot():
            pattern = re.escape(entry.get("Name").replace(" ", "")).replace(r"\*", ".*")
            strings = [(s.get("Condition"), s.text) for s in entry.iter(space + "DisplayString")]
            items = [i.text for i in entry.iter(space + "Item")]
            self.types.append((re.compile(pattern + "$"), strings, items))
        self.used = set()

    @staticmethod
    def evaluate(expression, value):
        """Names that are not scopes, nor members of something that is named, are the value's members."""
        this = "(*(%s*)%d)." % (value.type.unqualified().strip_typedefs(), int(value.address))
        return gdb.parse_and_eval(re.sub(r"(?<![\w.>:])([A-Za-z_]\w*)(?!\w*(::|\())", this + r"\1", expression))

    def words(self, value):
        code = value.type.strip_typedefs().code
        if code == gdb.TYPE_CODE_FLT:
            return "%.6g" % (float(value) + 0.0 if float(value) != 0 else 0.0)
        if code != gdb.TYPE_CODE_STRUCT:
            return str(int(value))
        name = str(value.type.unqualified().strip_typedefs()).replace(" ", "")
        for n, (pattern, strings, items) in enumerate(self.types):
            if not pattern.match(name):
                continue
            self.used.add(n)
            for item in items:
                self.evaluate(item, value)
            for condition, text in strings:
                if condition is None or bool(self.evaluate(condition, value)):
                    return re.sub(r"\{([^}]*)\}", lambda found: self.part(found.group(1), value), text)
        raise gdb.error("natvis has no words for " + name)

    def part(self, expression, value):
        expression, _, form = expression.partition(",")
        found = self.evaluate(expression, value)
        if form == "sb":
            return found.string()
        if form == "en":
            return str(found).split("::")[-1]
        return self.words(found)


def main():
    gdb.execute("set print pretty off")
    gdb.execute("set print frame-arguments none")
    gdb.execute("set startup-with-shell off")
    gdb.execute("break look_here", to_string=True)
    try:
        gdb.execute("run", to_string=True)
    except gdb.error as error:
        print("skipped: gdb may not run programs here: %s" % error)
        return 77
    gdb.execute("up", to_string=True)
    natvis, wrong = Natvis(os.environ["SINEW_NATVIS"]), 0
    for name, expected in EXPECTED.items():
        value = gdb.selected_frame().read_var(name)
        shown = [value.format_string()]
        if expected[-1] is not None:
            shown.append(natvis.words(value))
        for where, is_shown, should in zip(("gdb", "natvis"), shown, (expected[0], expected[-1])):
            if is_shown != should:
                print("%s shows %s as\n  %s\ninstead of\n  %s" % (where, name, is_shown, should))
                wrong += 1
    for n in set(range(len(natvis.types))) - natvis.used:
        print("natvis: nothing here is a " + natvis.types[n][0].pattern)
        wrong += 1
    print("%d variables, %d differences" % (len(EXPECTED), wrong))
    return 1 if wrong else 0


try:
    result = main()
except Exception:  # gdb itself would end with 0
    traceback.print_exc(file=sys.stdout)
    result = 1
sys.stdout.flush()
if gdb.selected_inferior().pid:
    gdb.execute("kill", to_string=True)
gdb.execute("quit %d" % result)
