"""What the GPU kernels do, counted from their SPIR-V: the tables of docs/gpu.md, written there.

    python benches/spirv.py            # has the modules written by a test first; needs spirv-opt and spirv-dis (Debian: spirv-tools)
    python benches/spirv.py FOLDER     # counts the .spv files of a folder; --loops NAME: all loops of one kernel

Modules pass `spirv-opt -O` first. Then every vector is taken apart, and only components that reach a store, an atomic or a branch count. A multiplication in
f32 or f64 whose only use is an addition is one operation with it, as drivers make them. In a loop over pairs, blocks that lead nowhere but to exact positions or to a
loop settle pairs next to an edge, and are left out.
"""

import argparse
import os
import re
import subprocess
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

from tables import ROOT, markdown, put

PAGE = ROOT / "docs/gpu.md"
KINDS = ["float", "integer", "compare, select", "convert", "special", "branches", "workgroup memory", "its atomics", "buffers", "their atomics"]


def spirv(folder):
    """The modules, by name."""
    command = ["cargo", "test", "--workspace", "--test", "gpu", "--", "--ignored", "spirv"]
    subprocess.run(command, cwd=ROOT, check=True, env=os.environ | {"PAIRWAVE_SPIRV": str(folder)}, stdout=subprocess.DEVNULL)


class Module:
    """One entry point as blocks of scalar operations."""

    def __init__(self, path):
        def text(*command):
            return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout

        listing = ("spirv-dis", "--no-indent", "--no-header", "--raw-id")
        # What is written and never read is still asked for.
        self.read(text(*listing, path))
        self.memory = sum(count * size for count, size in (self.width(self.types[self.kind[v]][1][1]) for v, where in self.storage.items() if where == "Workgroup"))
        with tempfile.NamedTemporaryFile(suffix=".spv") as small:
            text("spirv-opt", "--target-env=vulkan1.3", "-O", path, "-o", small.name)
            self.read(text(*listing, small.name))
        self.scalars()
        self.flow()

    def read(self, text):
        """A listing."""
        self.invocations = 1
        self.types, self.kind, self.constants, self.lanes, self.binding, self.storage = {}, {}, {}, set(), {}, {}
        self.blocks, self.order, block = {}, [], None
        self.definition = {}
        for line in text.splitlines():
            match = re.match(r"(?:(%\d+) = )?(Op\w+) ?(.*)", line)
            if not match:
                continue
            result, op, rest = match.groups()
            words = re.findall(r'"[^"]*"|\S+', rest)
            if op == "OpExecutionMode" and words[1] == "LocalSize":
                self.invocations = int(words[2])
            elif op == "OpDecorate" and words[1] == "Binding":
                self.binding[words[0]] = int(words[2])
            elif op == "OpDecorate" and words[1] == "BuiltIn":
                # What differs within a workgroup.
                if words[2] in ("LocalInvocationIndex", "LocalInvocationId", "GlobalInvocationId"):
                    self.lanes.add(words[0])
            elif op.startswith("OpType"):
                self.types[result] = (op, words)
            elif op.startswith("OpConstant") or op in ("OpUndef",):
                self.kind[result] = words[0]
                self.constants[result] = words[1:]
            elif op == "OpVariable":
                self.kind[result], self.storage[result] = words[0], words[1]
                self.definition[result] = None
            elif op == "OpExtInst":
                block.append((result, words[2], words[0], words[3:]))
            elif op == "OpLabel":
                block = self.blocks[result] = []
                self.order.append(result)
            elif block is not None and op not in ("OpFunctionEnd", "OpFunction"):
                typed = result is not None
                block.append((result, op.removeprefix("Op"), words[0] if typed else None, words[1:] if typed else words))
        for block in self.blocks.values():
            for result, op, kind, words in block:
                if result:
                    self.kind[result] = kind
                    self.definition[result] = (op, words)

    def width(self, kind):
        """Components of a type, and bytes of each."""
        op, words = self.types[kind]
        if op in ("OpTypeVector", "OpTypeMatrix"):
            count, size = self.width(words[0])
            return count * int(words[1]), size
        if op == "OpTypeStruct":
            parts = [self.width(w) for w in words]
            return sum(p[0] for p in parts), max(p[1] for p in parts)
        if op == "OpTypeArray":
            count, size = self.width(words[0])
            return count * int(self.constants[words[1]][0]), size
        if op == "OpTypeBool":
            return 1, 0
        return (1, int(words[0]) // 8) if op in ("OpTypeInt", "OpTypeFloat") else (1, 0)

    def parts(self, kind):
        op, words = self.types[kind]
        if op == "OpTypeStruct":
            return [self.width(w)[0] for w in words]
        if op in ("OpTypeVector", "OpTypeArray"):
            inner = self.width(words[0])[0]
            return [inner] * (self.width(kind)[0] // inner)
        return [1]

    def float(self, kind):
        op, words = self.types[kind]
        return self.float(words[0]) if op == "OpTypeVector" else op == "OpTypeFloat"

    def root(self, pointer):
        """The variable behind a pointer, and what the place depends on."""
        uses = []
        while self.definition.get(pointer):
            op, words = self.definition[pointer]
            uses += words[1:]
            pointer = words[0]
        return pointer, [u for u in uses if u not in self.constants]

    def component(self, value, c):
        """Where a component of a value is made: views are looked through."""
        while True:
            if value in self.constants:
                return None
            made = self.definition.get(value)
            if made is None:
                return (value, c)
            op, words = made
            if op == "CompositeExtract":
                kind = self.kind[words[0]]
                for index in map(int, words[1:]):
                    parts = self.parts(kind)
                    c += sum(parts[:index])
                    inner = self.types[kind]
                    kind = inner[1][index] if inner[0] == "OpTypeStruct" else inner[1][0]
                value = words[0]
            elif op == "CompositeConstruct":
                for word in words:
                    count = self.width(self.kind[word])[0]
                    if c < count:
                        value = word
                        break
                    c -= count
            elif op == "CompositeInsert":
                kind, at = self.kind[words[1]], 0
                for index in map(int, words[2:]):
                    at += sum(self.parts(kind)[:index])
                    inner = self.types[kind]
                    kind = inner[1][index] if inner[0] == "OpTypeStruct" else inner[1][0]
                count = self.width(kind)[0]
                value, c = (words[0], c - at) if at <= c < at + count else (words[1], c)
            elif op == "VectorShuffle":
                first = self.width(self.kind[words[0]])[0]
                at = int(words[2 + c])
                value, c = (words[0], at) if at < first else (words[1], at - first)
            elif op in ("Bitcast", "CopyObject", "CopyLogical"):
                value = words[0]
            else:
                return (value, c)

    def sources(self, value, c):
        """What a component is computed from: {(value, component)}."""
        op, words = self.definition[value]
        if op in ("Load", "AtomicIAdd", "AtomicLoad"):
            _, places = self.root(words[0])
            uses = [(p, 0) for p in places] + ([(words[3], 0)] if op == "AtomicIAdd" else [])
        elif op == "Phi":
            return []
        elif op in ("Any", "All", "VectorExtractDynamic"):
            uses = [(words[0], k) for k in range(self.width(self.kind[words[0]])[0])] + [(w, 0) for w in words[1:]]
        elif op in ("AccessChain", "ArrayLength"):
            uses = []
        else:
            uses = [(w, c if self.width(self.kind[w])[0] > 1 else 0) for w in words if w in self.kind]
        return [s for s in (self.component(*u) for u in uses) if s]

    def roots(self, instruction):
        """What an instruction without a result, or with an effect, needs."""
        result, op, kind, words = instruction
        if op == "Store":
            _, places = self.root(words[0])
            uses = [(p, 0) for p in places] + [(words[1], c) for c in range(self.width(self.kind[words[1]])[0])]
        elif op in ("AtomicIAdd", "AtomicStore"):
            _, places = self.root(words[0])
            uses = [(p, 0) for p in places] + [(words[3], 0)]
        elif op in ("BranchConditional", "Switch"):
            uses = [(words[0], 0)]
        else:
            return []
        return [s for s in (self.component(*u) for u in uses) if s]

    def scalars(self):
        """Components that reach anything."""
        self.incoming = {}
        for block in self.blocks.values():
            for result, op, kind, words in block:
                if op == "Phi":
                    self.incoming[result] = list(zip(words[0::2], words[1::2]))
        self.alive, todo = set(), [s for b in self.blocks.values() for i in b for s in self.roots(i)]
        while todo:
            at = todo.pop()
            if at in self.alive or not self.definition.get(at[0]):
                continue
            self.alive.add(at)
            todo += self.sources(*at)
            if self.definition[at[0]][0] == "Phi":
                todo += [s for v, _ in self.incoming[at[0]] for s in [self.component(v, at[1])] if s]
        self.uses = Counter()
        for block in self.blocks.values():
            for i in block:
                self.uses.update(self.roots(i))
        for value, c in self.alive:
            if value in self.incoming:
                self.uses.update(s for v, _ in self.incoming[value] for s in [self.component(v, c)] if s)
            elif self.definition[value][0] != "AtomicIAdd":
                self.uses.update(self.sources(value, c))
        # Products that are part of a sum, one of each sum.
        self.fused = set()
        for value, c in self.alive:
            if self.definition[value][0] in ("FAdd", "FSub"):
                products = [s for s in self.sources(value, c) if self.definition.get(s[0]) and self.definition[s[0]][0] in ("FMul", "VectorTimesScalar") and self.uses[s] == 1]
                self.fused |= set(products[:1])

    def flow(self):
        self.next = {}
        for label, block in self.blocks.items():
            result, op, kind, words = block[-1]
            self.next[label] = {"Branch": words[:1], "BranchConditional": words[1:3]}.get(op, [])
            if op == "Switch":
                self.next[label] = words[1:2] + words[3::2]
        self.before = defaultdict(list)
        for a, targets in self.next.items():
            for b in targets:
                self.before[b].append(a)
        # Which blocks every way to a block passes.
        first = self.order[0]
        self.above = {label: set(self.order) for label in self.order}
        self.above[first], changed = {first}, True
        while changed:
            changed = False
            for label in self.order[1:]:
                ways = [self.above[b] for b in self.before[label]]
                above = {label} | (set.intersection(*ways) if ways else set())
                if above != self.above[label]:
                    self.above[label], changed = above, True
        # Loops: a header, and all that comes back to it.
        self.loops = {}
        for label, block in self.blocks.items():
            if any(i[1] == "LoopMerge" for i in block):
                body, todo = {label}, [b for b in self.before[label] if label in self.above[b]]
                while todo:
                    at = todo.pop()
                    if at not in body:
                        body.add(at)
                        todo += self.before[at]
                if len(body) > 1 or label in self.next[label]:
                    self.loops[label] = body

    def depth(self, header):
        return sum(header in body for body in self.loops.values())

    def settles(self, label):
        """Whether a block reads exact positions, or says that they must be: it marks a bin as UNDECIDED."""
        for _, op, kind, words in self.blocks[label]:
            if op == "Load":
                variable = self.root(words[0])[0]
                if self.storage[variable] == "StorageBuffer" and self.binding[variable] == 3 and self.width(kind)[0] == 2:
                    return True
            if op == "BitwiseOr" and ["2147483648"] in [self.constants.get(w) for w in words]:
                return True
        return False

    def path(self, header, settle):
        """Blocks of a loop, without loops inside; with `settle` also without what leads to exact positions alone."""
        body = self.loops[header]
        inner = set().union(*(b for h, b in self.loops.items() if h != header and b < body), set())
        if not settle:
            return body - inner
        rare = inner | {b for b in body if self.settles(b)}
        while True:
            more = {b for b in body - rare - {header}
                    if (self.before[b] and all(p in rare for p in self.before[b])) or all(n in rare for n in self.next[b] if n in body and n != header) and any(n in body and n != header for n in self.next[b])}
            if not more:
                return body - rare
            rare |= more

    def count(self, labels):
        """Scalar operations by kind, and bytes read and written."""
        found = Counter()
        for label in labels:
            for result, op, kind, words in self.blocks[label]:
                live = [c for c in range(self.width(kind)[0]) if (result, c) in self.alive] if result and self.types[kind][0] != "OpTypePointer" else []
                n = len(live)
                if op in ("Load", "Store", "AtomicIAdd", "AtomicStore", "AtomicLoad"):
                    variable, _ = self.root(words[0])
                    place = "workgroup" if self.storage[variable] == "Workgroup" else "buffer"
                    if self.storage[variable] in ("Function", "Input", "Uniform", "Private"):
                        found["uniform loads"] += n
                        continue
                    if op == "Load" and not n:
                        continue
                    if op == "AtomicIAdd":
                        found["its atomics" if place == "workgroup" else "their atomics"] += 1
                    else:
                        found["workgroup memory" if place == "workgroup" else "buffers"] += 1
                    size = self.width(kind) if op == "Load" else self.width(self.kind[words[1]]) if op == "Store" else (1, 4)
                    found[f"{place} bytes"] += (n if op == "Load" else size[0]) * size[1]
                elif op == "BranchConditional":
                    found["branches"] += 1
                elif op == "ControlBarrier":
                    found["barriers"] += 1
                elif op in ("FAdd", "FSub", "FMul", "VectorTimesScalar", "Fma"):
                    found["float"] += sum((result, c) not in self.fused for c in live)
                elif op in ("FNegate", "FAbs"):
                    # A sign on an operand.
                    pass
                elif op in ("IAdd", "ISub", "IMul", "ShiftLeftLogical", "ShiftRightLogical", "ShiftRightArithmetic", "BitwiseAnd", "BitwiseOr", "BitwiseXor", "Not", "UMin", "UMax", "SMin", "SMax", "UClamp", "SNegate"):
                    found["integer"] += n
                elif op in ("UDiv", "UMod"):
                    # By a power of 2 a shift or a mask.
                    divisor = int((self.constants.get(words[1]) or ["0"])[0])
                    found["integer" if divisor and divisor & (divisor - 1) == 0 else "? division"] += n
                elif op in ("ConvertUToF", "ConvertSToF", "ConvertFToU", "ConvertFToS", "FConvert"):
                    found["convert"] += n
                    found["convert from integer"] += n if op.endswith("ToF") else 0
                elif op in ("Sqrt", "InverseSqrt", "RoundEven", "Floor", "FDiv", "Ceil", "Trunc"):
                    found["special"] += n + (n if op == "FDiv" else 0)
                elif op in ("FMin", "FMax", "NMin", "NMax", "FClamp", "NClamp"):
                    found["compare, select"] += n * (2 if op.endswith("Clamp") else 1)
                elif op in ("Select", "Any", "All") or op.startswith(("FOrd", "FUnord", "ULess", "UGreater", "SLess", "SGreater", "IEqual", "INotEqual", "Logical")):
                    found["compare, select"] += n * (self.width(self.kind[words[0]])[0] - 1 if op in ("Any", "All") else 1)
                elif n and op not in ("Phi", "CompositeExtract", "CompositeConstruct", "CompositeInsert", "VectorShuffle", "Bitcast", "CopyObject", "CopyLogical", "VectorExtractDynamic", "ArrayLength"):
                    found[f"? {op}"] += n
        return found

    def registers(self):
        """The most 32-bit words alive at once, those that differ between invocations and the others."""
        varying = self.varying()
        size = {s: max(1, self.width(self.kind[s[0]])[1] // 4) if self.width(self.kind[s[0]])[1] else 0 for s in self.alive}
        needs = {}
        for label, block in self.blocks.items():
            steps = []
            for i in block:
                result, op, kind, words = i
                made = [(result, c) for c in range(self.width(kind)[0]) if (result, c) in self.alive] if result and self.types[kind][0] != "OpTypePointer" else []
                used = set(self.roots(i))
                if op not in ("Phi", "CompositeExtract", "CompositeConstruct", "CompositeInsert", "VectorShuffle", "Bitcast", "CopyObject", "CopyLogical"):
                    for s in made:
                        used |= set(self.sources(*s))
                real = [s for s in made if self.component(*s) == s]
                steps.append((op, real, used))
            needs[label] = steps
        out = {label: set() for label in self.blocks}
        into = {label: set() for label in self.blocks}
        changed = True
        while changed:
            changed = False
            for label in reversed(self.order):
                live = set()
                for n in self.next[label]:
                    phis = [s for op, real, _ in needs[n] if op == "Phi" for s in real]
                    live |= into[n] - set(phis)
                    live |= {s for value, c in phis for v, origin in self.incoming[value] if origin == label for s in [self.component(v, c)] if s}
                if live != out[label]:
                    out[label], changed = live, True
                for op, real, used in reversed(needs[label]):
                    if op == "Phi":
                        continue
                    live = (live - set(real)) | used
                phis = {s for op, real, _ in needs[label] if op == "Phi" for s in real}
                live = live | phis
                if live != into[label]:
                    into[label], changed = live, True
        most = (0, 0)
        for label in self.blocks:
            live = set(out[label])
            for op, real, used in reversed(needs[label]):
                here = live | set(real)
                each = sum(size.get(s, 0) for s in here if s in varying)
                alike = sum(size.get(s, 0) for s in here if s not in varying)
                most = max(most, (each, alike))
                if op != "Phi":
                    live = (live - set(real)) | used
        return most

    def varying(self):
        varying, changed = set(), True
        while changed:
            changed = False
            for s in self.alive:
                if s in varying:
                    continue
                op, words = self.definition[s[0]]
                uses = self.sources(*s)
                if op == "Phi":
                    uses = [t for v, _ in self.incoming[s[0]] for t in [self.component(v, s[1])] if t]
                own = op == "AtomicIAdd"
                if op in ("Load", "AtomicLoad"):
                    variable = self.root(words[0])[0]
                    own = variable in self.lanes or self.storage[variable] == "Workgroup"
                if own or any(u in varying for u in uses):
                    varying.add(s)
                    changed = True
        return varying


def loops(module, name):
    """What is counted of a kernel: (of what, how many an iteration does, operations)."""
    depth = {h: module.depth(h) for h in module.loops}
    ways = {(h, settle): module.count(module.path(h, settle)) for h in module.loops for settle in (False, True)}
    inner = [h for h in module.loops if not any(o != h and module.loops[o] < module.loops[h] for o in module.loops)]
    own = {h: ways[h, False] for h in module.loops}
    family = name.split()[0]
    if family in ("pairs", "cells", "lags"):
        # Of the two loops over a tile, the one that most tiles take.
        hot = [h for h in module.loops if depth[h] == 2 and any("atomics" in kind for kind in ways[h, True])]
        hot = min(hot, key=lambda h: total(ways[h, True]))
        return [("pair", 1 if family == "lags" else 4, ways[hot, True])]
    if family == "sort":
        outer = next(h for h in module.loops if depth[h] == 1)
        dim = int(name[5])
        found = Counter(own[outer])
        for h in inner:
            for kind, n in own[h].items():
                found[kind] += dim * n if h != outer else 0
        return [("point", 1, found)]
    if family == "power":
        table = max(inner, key=lambda h: own[h]["convert"])
        panel = next(h for h in module.loops if depth[h] == 1)
        rows = [("table entry", 1, own[table]),
                ("carry of a panel", 1, own[panel])]
        products = [h for h in inner if h != table and own[h]["float"] >= 64]
        if products:
            product = products[0]
            rows.insert(0, ("point, 4 rows by 4 columns", 4, own[product]))
        return rows
    if family == "fold":
        chunk = max(inner, key=lambda h: own[h]["buffers"])
        return [("chunk", 1, own[chunk])]
    return [("input", 1, module.count(module.blocks))]


def total(found):
    return sum(found[kind] for kind in KINDS)


# Words that a compiler needs beside the live ones, for addresses and what is under way: a guess.
BESIDE = 8
MULTIPROCESSORS, HERTZ = 132, 1.98e9


def busy(found, double=False, integers=16):
    """Clocks of a Hopper multiprocessor that its units take, if nothing waits; integers are converted to floats at `integers` a clock."""
    slow = found["convert from integer"] / integers + (found["convert"] - found["convert from integer"] + found["special"]) / 16
    return {
        "issue": total(found) / 128, "float": found["float"] / (64 if double else 128), "integer, compare": (found["integer"] + found["compare, select"]) / 64,
        "convert, special": slow, "workgroup memory": found["workgroup bytes"] / 128,
    }


def least(limits):
    """The workgroups that fit, and what ends them."""
    by = min(limits, key=limits.get)
    return int(limits[by]), by


def hopper(lanes, words, memory):
    registers = -(-(words + BESIDE) // 8) * 8
    return least({"registers": 65536 // (registers * 32) // (lanes // 32), "memory": 228 * 1024 // (memory + 1024), "invocations": 2048 // lanes, "workgroups": 32})


def rdna3(lanes, words, memory):
    waves = 1536 // (-(-(words + BESIDE) // 24) * 24)
    return least({"registers": 4 * waves // (lanes // 32), "memory": 128 * 1024 // max(memory, 1), "invocations": 2048 // lanes})


def xe(lanes, words, memory):
    width = next((width for width, room in ((16, 64), (8, 128)) if words + BESIDE <= room), 4)
    return least({"registers": 128 * width // lanes, "memory": 128 * 1024 // max(memory, 1)})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, help="of .spv files")
    parser.add_argument("--loops", help="prints every loop of the kernels with this in their name instead")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as own:
        folder = given.folder or Path(own)
        if not given.folder:
            spirv(folder)
        modules = {path.stem: Module(path) for path in sorted(folder.glob("*.spv"), key=lambda path: path.stem) if (given.loops or "") in path.stem}
    if given.loops:
        for name, module in modules.items():
            print(name, "at most", module.registers())
            for header in module.loops:
                for settle in (False, True):
                    labels = module.path(header, settle)
                    print("  ", header, "depth", module.depth(header), "of", len(module.loops[header]), "blocks", len(labels),
                          "without settling" if settle else "own", dict(module.count(labels)))
        return
    plain = " unchecked"
    workgroups, operations, rates, panels = [], [], [], {}
    for name, module in modules.items():
        if name.endswith(plain):
            continue
        each, alike = module.registers()
        fits = [at(module.invocations, each, module.memory) for at in (hopper, rdna3, xe)]
        cells = [f"{n}, {by}: {100 * n * module.invocations // 2048}%" for n, by in fits]
        if "f64" in name:
            cells[2] = "no f64"
        workgroups.append([name, module.invocations, module.memory, f"{each} + {alike}", *cells])
        for (what, units, found), (_, _, bare) in zip(loops(module, name), loops(modules[name + plain], name)):
            unknown = [kind for kind in found if kind.startswith("?")]
            assert not unknown, (name, unknown)
            cells = [f"{found[kind] / units:.3g}" if found[kind] else "" for kind in KINDS]
            bytes_ = f"{found['buffer bytes'] / units:.3g}" if found["buffer bytes"] else ""
            operations.append([name, what, *cells, f"{total(found) / units:.3g}", f"{total(bare) / units:.3g}", bytes_])
            if what == "pair":
                times = [busy(found, False, integers) for integers in (16, 64)]
                rates.append([name, *(f"{v / units:.3f}" if v else "" for v in times[0].values()),
                              *(f"{MULTIPROCESSORS * HERTZ * units / max(t.values()):.2g}" for t in times)])
            if name.startswith("power"):
                panels.setdefault(name, []).append((what, units, found, bare))
    header = ["kernel", "invocations", "bytes", "words", "Hopper", "RDNA 3", "Xe-HPG"]
    put(PAGE, "workgroups", markdown(header, workgroups))
    put(PAGE, "operations", markdown(["kernel", "per", *KINDS, "all", "unchecked", "buffer bytes"], operations))
    put(PAGE, "pairs", markdown(["kernel", *busy(Counter()), "pairs/s", "integers at 64"], rates))
    rows = []
    for name, parts in panels.items():
        if len(parts) < 3:
            continue
        # 64 points: a panel in f32.
        work = 64 * 64
        for checks, place in (("", 2), (", unchecked", 3)):
            sum_ = Counter()
            for part, times in zip(parts, (64 / parts[0][1], 64 * 32 / 256, 1 if "f32" in name else 0)):
                for kind, n in part[place].items():
                    sum_[kind] += times * n
            units = busy(sum_, "f64" in name)
            by = max(units, key=units.get)
            rows.append([name + checks, f"{total(sum_):.0f}", work, *(f"{clocks:.1f}" for clocks in units.values()), f"{MULTIPROCESSORS * HERTZ * work * 2 / units[by] * 1e-12:.3g}"])
    put(PAGE, "power", markdown(["kernel", "operations", "multiply-adds", *busy(Counter()), "TFLOP/s"], rows))


if __name__ == "__main__":
    main()
