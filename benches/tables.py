"""The tables of the README, measured anew: each by one command, with date, machine and versions; docs/benchmarks.md keeps what they were.

    python benches/tables.py                        # all but peers
    PEERS/bin/python benches/tables.py peers spectra   # where Corrfunc, freud, SciPy and FINUFFT are installed: benches/peers/README.md
"""

import argparse
import csv
import datetime
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
README, HISTORY = ROOT / "README.md", ROOT / "docs/benchmarks.md"


def run(*command):
    """What a command prints."""
    print("$", *command, file=sys.stderr, flush=True)
    return subprocess.run([str(c) for c in command], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def machine():
    """Processor, cores and memory, in words."""
    info = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*: (.*)", info.read_text()) if info.exists() else []
    return f"{names[0] if names else platform.processor() or platform.machine()}, {len(names) or '?'} cores"


def versions():
    """Of the program and its compiler."""
    package = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)
    return f"pairwave {package[1]}, {' '.join(run('rustc', '--version').split()[:2])}"


def markdown(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


def throughput():
    """Rates of the kernels on one thread, of the best instruction set."""
    command = ["cargo", "bench", "--bench", "throughput"]
    text = run(*command).strip()
    first = re.search(r"^(.*), per second of processor time\n.*\n((?:.+\n)+)", text, re.M)
    rows, limit = [], None
    for line in first[2].splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if cells[0].startswith("f32 multiply-add"):
            limit = f"{float(cells[1]):.0f} GFLOP/s"
            continue
        rows.append([cells[0], f"{float(cells[1]):.3g} {cells[2]}", cells[3]])
    rows.append(["f32 multiply-adds in a loop, the limit", limit, "1"])
    short = {"pairs 2D, n = 10000, r < 0.5, 256 bins": "pairs", "spectrum 2D direct f32, 1 x n = 16384, M = 256": "P, f32"}
    facts = {short[row[0]]: row[1] for row in rows if row[0] in short}
    return command, markdown([first[1], "rate", "per GFLOP/s of the loop"], rows), facts | {"limit": limit}


def accuracy():
    """What exact and promised numbers err by, and take, beside plain loops."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["cargo", "run", "--release", "--", "bench", "--only", "pairs,kernel,spectrum", "--device", "cpu"]
        run(*command, "--quiet", "--out", Path(folder) / "bench")
        with open(Path(folder) / "bench/bench.csv", newline="") as file:
            ways = list(csv.DictReader(file))
    rows = []
    for way in ways:
        error = [f"{float(way[name]):.1e}" if way[name] else "chance" for name in ("error_rms", "error_max")]
        later = f"{float(way['k_as_accurate']):.0e}" if way["k_as_accurate"] else ""
        rows.append([way["scene"], way["method"], f"{1e3 * float(way['seconds']):.3g} ms", *error, later])
    header = ["of", "method", "a realization", "error, rms", "largest", "less than chance up to K"]
    return command, markdown(header, rows), {}


def of_peers(script):
    """The table that a script prints in Markdown."""
    command = ["python", f"benches/peers/{script}"]
    text = run(sys.executable, ROOT / "benches/peers" / script)
    modules = ("numpy", "scipy", "Corrfunc", "freud", "finufft")
    from importlib.metadata import PackageNotFoundError, version

    found = []
    for name in modules:
        try:
            found.append(f"{name} {version({'freud': 'freud-analysis'}.get(name, name))}")
        except PackageNotFoundError:
            pass
    return command, text.strip(), {"peers": ", ".join(found)}


TABLES = {
    "throughput": throughput,
    "accuracy": accuracy,
    "peers": lambda: of_peers("compare.py"),
    "spectra": lambda: of_peers("spectra.py"),
}


def put(path, name, text):
    """`text` in place of what stands between the marks of `name`."""
    page = path.read_text()
    pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.S)
    if not pattern.search(page):
        sys.exit(f"{path}: there is no place for {name}: <!-- {name} --> ... <!-- end of {name} -->")
    path.write_text(pattern.sub(lambda m: f"{m[1]}{text}\n{m[2]}", page))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", default=["throughput", "accuracy"], help=", ".join(TABLES))
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.tables if name not in TABLES]:
        parser.error(f"{unknown[0]} is no table; expected {', '.join(TABLES)}")
    today = datetime.date.today().isoformat()
    for name in arguments.tables:
        command, table, facts = TABLES[name]()
        peers = facts.pop("peers", "")
        by = f"`{' '.join(command)}`, {today}, {machine()}; {', '.join(filter(None, [versions(), peers]))}"
        place = HISTORY if name == "accuracy" else README
        put(place, name, f"{by}:\n\n{table}\n")
        said = "; ".join(f"{key} {value}" for key, value in facts.items())
        history = HISTORY.read_text().rstrip("\n")
        HISTORY.write_text(f"{history}\n| {today} | {name} | {machine()} | {versions()} | {said} |\n")


if __name__ == "__main__":
    main()
