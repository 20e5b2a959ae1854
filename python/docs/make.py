"""Builds the site: the pages of this folder and every function. `pip install pdoc`, then `python docs/make.py site`; needs no network."""

import pathlib
import sys

import pdoc
from pdoc.render_helpers import to_html

HERE = pathlib.Path(__file__).resolve().parent
PAGES = [(HERE.parent / "README.md", "index", "pairwave"), (HERE / "tutorial.md", "tutorial", "Tutorial")]
PAGES += [(HERE / "coming-from.md", "coming-from", "Coming from"), (HERE / "cluster.md", "cluster", "Cluster")]
PAGES += [(HERE.parents[1] / "docs" / "scale.md", "scale", "What it costs")]

STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:56rem;margin:2rem auto;padding:0 1rem;color:#222}
nav a{margin-right:1.2rem}pre{background:#f5f5f5;padding:.8rem;overflow-x:auto}code{background:#f5f5f5}
table{border-collapse:collapse;display:block;overflow-x:auto}td,th{border:1px solid #ccc;padding:.3rem .6rem;vertical-align:top}a{color:#0072b2}"""


def main(out: pathlib.Path) -> None:
    pdoc.render.configure(docformat="numpy")
    pdoc.pdoc("pairwave", "pairwave.distributed", output_directory=out)
    (out / "index.html").rename(out / "functions.html")
    links = [f'<a href="{name}.html">{title}</a>' for _, name, title in PAGES]
    nav = "<nav>" + "".join([*links, '<a href="pairwave.html">Functions</a>']) + "</nav>"
    for path, name, title in PAGES:
        text = path.read_text()
        for source, target, _ in PAGES:
            for prefix in ("docs/", "../docs/", ""):
                text = text.replace(f"]({prefix}{source.name})", f"]({target}.html)")
        page = f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style><body>{nav}{to_html(text)}</body></html>'
        (out / f"{name}.html").write_text(page)
    print(f"{out}: {len(PAGES)} pages")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "site"))
