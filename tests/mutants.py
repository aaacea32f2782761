#!/usr/bin/python3
"""Puts faults into sources, one at a time, and lists those that the tests of their room do not notice.

usage: mutants.py [--since COMMIT] [--most N] [--longest S] [--jobs N] [FILES]

FILES are sources (.cpp) of one folder: base, devices, engine, render, scene or study; without them, those that changed since
COMMIT (HEAD). Whatever their room is, the tests are those of the folder.
--most takes N of the faults, evenly spread. --longest leaves out the tests that take more than S seconds.
--jobs tries N faults at a time (default: one for each core); more are quicker where tests wait for time to pass.

A fault is one operator, statement or condition that is another: see `edits`. libclang says where they are; all are put into
a copy of the sources as switches, so that the copy is built once, and a run of the tests turns one of them on: of those that
come by it, first those that come by few others, then the quick ones. What no test comes by is listed without a run. Where this is run by root, nothing but /tmp can be written by a program with a fault.
"""

import argparse
import ctypes
import concurrent.futures
import filecmp
import fnmatch
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import threading
import time

from clang import cindex
from clang.cindex import CursorKind as Kind
from clang.cindex import TypeKind

TESTS = {"base": ["base"], "devices": ["devices"], "engine": ["engine", "laws"], "render": ["render"], "scene": ["scene"],
         "study": ["study"]}
COPY = "build/mutants"
OTHER = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/", "/": "*",
         "&&": "||", "||": "&&", "&": "|", "|": "&", "<<": ">>", ">>": "<<"}
NUMBERS = {TypeKind.BOOL, TypeKind.INT, TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG,
           TypeKind.SHORT, TypeKind.USHORT, TypeKind.CHAR_S, TypeKind.UCHAR, TypeKind.SCHAR, TypeKind.DOUBLE, TypeKind.FLOAT,
           TypeKind.ENUM, TypeKind.POINTER}


def is_number(cursor):
    return cursor.type.get_canonical().kind in NUMBERS


def children(cursor):
    return list(cursor.get_children())


def operator_between(text, left, right):
    """The operator between two operands, as it stands there."""
    between = re.sub(r"/\*.*?\*/|//[^\n]*", lambda m: " " * len(m[0]), text[left.extent.end.offset:right.extent.start.offset])
    found = re.fullmatch(r"[\s()]*?(<=|>=|==|!=|&&|\|\||<<|>>|[-<>+*/&|])[\s(]*", between)
    return found and (found[1], left.extent.end.offset + found.start(1))


def is_constant(cursor):
    """Inside it a switch cannot stand: the compiler has to know the value."""
    if cursor.kind in (Kind.STATIC_ASSERT, Kind.ENUM_CONSTANT_DECL, Kind.TEMPLATE_TYPE_PARAMETER, Kind.PARM_DECL):
        return True
    if cursor.kind not in (Kind.VAR_DECL, Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.FIELD_DECL, Kind.FUNCTION_TEMPLATE):
        return False
    for token in cursor.get_tokens():
        if token.spelling in ("constexpr", "consteval"):
            return True
        if token.spelling in ("=", "{", "("):
            return False
    return False


def is_if_constexpr(cursor):
    """Whether the first part of a statement is the condition of an `if constexpr`."""
    if cursor.kind != Kind.IF_STMT:
        return False
    tokens = cursor.get_tokens()
    return [next(tokens).spelling, next(tokens).spelling] == ["if", "constexpr"]


def edits(unit, path, text):
    """Faults: (begin, end, what is put before, behind, name); the text between is kept and may hold others."""
    found = []

    def here(cursor):
        begin = cursor.extent.start
        return begin.file is not None and begin.file.name == path and text[begin.offset:cursor.extent.end.offset].strip()

    def add(cursor, other, name):
        found.append((cursor.extent.start.offset, cursor.extent.end.offset, other, name, cursor.extent.start.line))

    def visit(cursor, parent):
        if is_constant(cursor):
            return
        parts = children(cursor)
        if here(cursor):
            if cursor.kind == Kind.BINARY_OPERATOR and len(parts) == 2 and all(is_number(part) for part in parts):
                between = operator_between(text, *parts)
                if between and between[0] in OTHER:
                    sign, at = between
                    if is_number(cursor) and not (sign in "+-" and TypeKind.POINTER in [p.type.get_canonical().kind for p in parts]):
                        add(cursor, lambda body, at=at, sign=sign, begin=cursor.extent.start.offset:
                            body(at - begin, len(sign), OTHER[sign]), f"{sign} -> {OTHER[sign]}")
            elif cursor.kind == Kind.UNARY_OPERATOR and parts and is_number(parts[0]):
                begin = cursor.extent.start.offset
                if text[begin] == "!" and text[begin + 1] != "=":  # a != b is !(a == b) to the compiler
                    add(cursor, lambda body: body(0, 1, "!!"), "! left out")  # !! is bool, as ! is
            elif cursor.kind == Kind.CXX_BOOL_LITERAL_EXPR:
                word = text[cursor.extent.start.offset:cursor.extent.end.offset]
                if word in ("true", "false"):
                    add(cursor, lambda body, word=word: body(0, len(word), "false" if word == "true" else "true"),
                        f"{word} turned")
            elif cursor.kind == Kind.CALL_EXPR and parent.kind == Kind.COMPOUND_STMT:
                end = cursor.extent.end.offset
                if text[end:end + 1] == ";":
                    add(cursor, None, "statement left out")
        if cursor.kind == Kind.VAR_DECL and any(part.kind == Kind.TEMPLATE_REF for part in parts):
            parts = parts[-1:]  # the others are in its type
        for part in parts[is_if_constexpr(cursor):]:
            visit(part, cursor)

    for cursor in unit.cursor.get_children():
        if cursor.location.file is not None and cursor.location.file.name == path:
            visit(cursor, unit.cursor)
    return found


def with_switches(text, found, first):
    """The text with all faults in it, each behind its number; inner ones stand in both arms."""
    numbered = sorted(enumerate(found, first), key=lambda item: (item[1][0], -item[1][1]))

    def render(begin, end, items):
        """text[begin:end] with the faults in `items`, which are inside it, outermost first."""
        out, at = [], begin
        while items:
            number, (from_, to, other, _, _) = items[0]
            inner = [item for item in items[1:] if item[1][1] <= to]
            items = [item for item in items[1:] if item[1][1] > to]
            out.append(text[at:from_])
            whole = render(from_, to, inner)
            if other is None:
                out.append(f"if (!headpin_mutant({number})) {whole}")
            else:
                # The other arm has no faults inside: only one is on at a time.
                plain = text[from_:to]
                changed = other(lambda start, size, new: plain[:start] + new + plain[start + size:])
                out.append(f"(headpin_mutant({number}) ? ({changed}) : ({whole}))")
            at = to
        out.append(text[at:end])
        return "".join(out)

    return render(0, len(text), numbered)


def arguments_of(path, database):
    folder = path.split("/")[0]
    for entry in database:
        words = shlex.split(entry["command"])[1:]
        if not words[words.index("-o") + 1].startswith(f"{folder}/CMakeFiles/headpin_{folder}.dir/"):
            continue
        paired = {"-isystem": 2, "-I": 2, "-D": 2}
        arguments, at = [], 0
        while at < len(words):
            size = paired.get(words[at], 1)
            if words[at].startswith(("-I", "-D", "-std", "-isystem")):
                arguments += words[at:at + size]
            at += size
        return arguments
    raise SystemExit(f"{path}: not built by build/release; expected `./dev test` before")


def copy_sources(top):
    """Makes `top` the sources. What is the same there keeps its time; what had faults in it is built again."""
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    listed = set(names)
    for folder, _, found in os.walk(top):
        for name in found:
            path = os.path.join(folder, name)
            if os.path.relpath(path, top) not in listed:
                os.unlink(path)
    for name in names:
        to = os.path.join(top, name)
        if os.path.isfile(name) and not (os.path.isfile(to) and filecmp.cmp(name, to, shallow=False)):
            os.makedirs(os.path.dirname(to), exist_ok=True)
            shutil.copyfile(name, to)
            shutil.copymode(name, to)


def build(top, rooms):
    log = os.path.join(COPY, "build.log")
    with open(log, "w", encoding="utf-8") as out:
        for words in (["cmake", "-S", top, "-B", COPY + "/build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                       "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=8"],
                      ["cmake", "--build", COPY + "/build", "--target",
                       *[f"{name}_test" for room in rooms for name in TESTS[room]]]):
            if subprocess.run(words, stdout=out, stderr=subprocess.STDOUT, check=False).returncode != 0:
                with open(log, encoding="utf-8") as file:
                    return file.read()
    return ""


def nothing_can_be_written():
    """Makes all but /dev and /proc read-only for this process and what it starts: a fault may remove what it should not."""
    if ctypes.CDLL(None, use_errno=True).unshare(0x00020000) != 0:  # CLONE_NEWNS
        raise SystemExit("expected to get mounts of its own: " + os.strerror(ctypes.get_errno()))
    subprocess.run(["mount", "--make-rprivate", "/"], check=True)
    for target in subprocess.run(["findmnt", "-rno", "TARGET"], check=True, capture_output=True, text=True).stdout.splitlines():
        if not re.match(r"/(proc|dev|sys)", target):
            subprocess.run(["mount", "-o", "remount,ro,bind", target], check=False, stderr=subprocess.DEVNULL)


def program_of(name):
    return os.path.abspath(f"{COPY}/build/tests/{name}/{name}_test")


def run_tests(name, tests, environment, limit_s):
    """@param limit_s  of the processor; on a busy machine it is longer by the clock
    @return  whether all of these passed; what was said"""
    words = [program_of(name), "--gtest_brief=1", "--gtest_fail_fast", "--gtest_filter=" + ":".join(tests)]
    words = ["bash", "-c", f"ulimit -v 8000000; ulimit -t {limit_s}; exec timeout -k 5 {6 * limit_s} \"$@\"", "-", *words]
    if os.geteuid() == 0:  # its own /tmp: see nothing_can_be_written
        words = ["unshare", "-m", "bash", "-c", "mount -t tmpfs none /tmp || exit 9; exec \"$@\"", "-", *words]
    done = subprocess.run(words, env={**os.environ, **environment}, capture_output=True, stdin=subprocess.DEVNULL, check=False)
    return done.returncode == 0, done.stdout + done.stderr


def names_of(name):
    """The tests of a program, as its filter takes them; long ones (tests/CMakeLists.txt) are left out."""
    words = [program_of(name), "--gtest_list_tests"]
    suite, names = "", []
    for line in subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines():
        text = line.split("#")[0].rstrip()
        if not line.startswith(" "):
            suite = text
        else:
            names.append(suite + text.strip())
    with open(f"tests/{name}/CMakeLists.txt", encoding="utf-8") as file:
        left_out = re.findall(r"^\s*([A-Za-z0-9_./*]+\.[A-Za-z0-9_/*]+)$", file.read(), re.M)
    return [test for test in names
            if "DISABLED_" not in test and not any(fnmatch.fnmatchcase(test, pattern) for pattern in left_out)]


def tried_alone(name, test):
    """@return  what faults a test comes by, and how long it takes [s]"""
    reached = f"/dev/shm/headpin-mutants-{os.getpid()}-{threading.get_ident()}"
    with open(reached, "wb") as file:
        file.write(bytes(1 << 16))
    begin = time.monotonic()
    passed, said = run_tests(name, [test], {"HEADPIN_MUTANTS_REACHED": reached, "HEADPIN_MUTANT": "0"}, 3600)
    took = time.monotonic() - begin
    if not passed:
        raise SystemExit(f"{test} fails without a fault:\n{said.decode(errors='replace')[-3000:]}")
    with open(reached, "rb") as file:
        came_by = {number for number, byte in enumerate(file.read()) if byte}
    os.unlink(reached)
    return came_by, took


def prepare(paths, top, most):
    with open("build/release/compile_commands.json", encoding="utf-8") as file:
        database = json.load(file)
    mutants, first = {}, 1
    for path in paths:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if not text.isascii():
            raise SystemExit(f"{path}: expected ASCII")
        unit = cindex.Index.create().parse(path, args=arguments_of(path, database))
        wrong = [d.spelling for d in unit.diagnostics if d.severity >= cindex.Diagnostic.Error]
        if wrong:
            raise SystemExit(f"{path}: clang: {wrong[0]}")
        found = edits(unit, path, text)
        for number, (_, _, _, name, line) in enumerate(found, first):
            mutants[number] = (path, line, name)
        with open(os.path.join(top, path), "w", encoding="utf-8") as file:
            file.write('#include "tests/mutants.h"\n' + with_switches(text, found, first))
        first += len(found)
    numbers = sorted(mutants)
    if most and most < len(numbers):
        numbers = [numbers[i * len(numbers) // most] for i in range(most)]
    return {number: mutants[number] for number in numbers}


def in_order(tests):
    """Groups of tests: those that come by the fewest faults, most likely meant for one of them; then the quick, then all others."""
    closest = sorted((one for one in tests if one[3] < 2.0), key=lambda one: (len(one[2]), one[1]))[:8]
    others = [one for one in tests if one not in closest]
    groups = [closest] + [[one for one in others if low <= one[3] < high] for low, high in ((0.0, 0.2), (0.2, 2.0), (2.0, 1e9))]
    return [group for group in groups if group]


def state_of(number, tests):
    """Tries a fault with the tests that come by it.

    @param tests  (program, test, what it comes by, how long it takes)
    """
    mine = [one for one in tests if number in one[2]]
    if not mine:
        return "no test came by"
    for group in in_order(mine):
        for name in sorted({one[0] for one in group}):
            which = [one for one in group if one[0] == name]
            limit_s = 10 + int(5 * sum(took for *_, took in which))  # what takes longer does not end
            if not run_tests(name, [test for _, test, *_ in which], {"HEADPIN_MUTANT": str(number)}, limit_s)[0]:
                return "noticed"
    return "SURVIVED"


def try_all(mutants, room, longest, jobs):
    """@return  by number, what became of it"""
    states = {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        which = [(name, test) for name in TESTS[room] for test in names_of(name)]
        alone = pool.map(lambda one: tried_alone(*one), which)
        tests = [(name, test, *tried) for (name, test), tried in zip(which, alone)]
        tests = [one for one in tests if one[3] <= longest]
        print(f"{len(tests)} tests of {len(which)}, {sum(took for *_, took in tests):.0f} s one by one", flush=True)
        results = pool.map(lambda number: state_of(number, tests), mutants)
        for count, (number, state) in enumerate(zip(mutants, results), 1):
            states[number] = state
            path, line, name = mutants[number]
            print(f"{count}/{len(mutants)} {path}:{line}: {name}: {state}", flush=True)
    return states


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--since", default="HEAD")
    parser.add_argument("--most", type=int, default=0)
    parser.add_argument("--longest", type=float, default=1e9)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    changed = subprocess.run(["git", "diff", "--name-only", options.since], check=True, capture_output=True, text=True).stdout
    paths = [p for p in options.files or changed.splitlines() if p.endswith(".cpp") and p.split("/")[0] in TESTS]
    if not paths:
        raise SystemExit("nothing of " + ", ".join(TESTS) + " has changed; expected FILES")
    rooms = sorted({path.split("/")[0] for path in paths})
    if len(rooms) > 1:
        raise SystemExit("files of one room at a time, found " + ", ".join(rooms))
    top = os.path.abspath(COPY + "/src")
    copy_sources(top)
    mutants = prepare(paths, top, options.most)
    wrong = build(top, rooms)
    if wrong:
        raise SystemExit("with the faults in it, it does not build:\n" + wrong[-4000:])
    if os.geteuid() == 0:
        nothing_can_be_written()
    states = list(try_all(mutants, rooms[0], options.longest, options.jobs).values())
    count = {state: states.count(state) for state in ("noticed", "SURVIVED", "no test came by")}
    print(f"{rooms[0]}: {len(states)} faults, {count['noticed']} noticed ({100 * count['noticed'] / max(1, len(states)):.0f} %), "
          f"{count['SURVIVED']} survived, {count['no test came by']} where no test came by")
    return 0


if __name__ == "__main__":
    sys.exit(main())
