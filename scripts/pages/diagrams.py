"""Diagrams of the documentation, from their sources: the layers by the table of scripts/check-layers, the data flow of
a tick by the table "One tick" of docs/DESIGN.md.
"""
import html
import importlib.machinery
import importlib.util
import pathlib
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
INK, SOFT, EDGE, CARD, ACCENT = "#1c2530", "#5d6978", "#c3cbd4", "#ffffff", "#0b6e69"
ABOUT = {
    "core": "the control algorithm, freestanding", "hal": "contracts of a board, control loop",
    "host": "libraries for a PC", "tools": "programs", "firmware": "boards, start-up code",
}
# Centre of each folder from left to right, so that no arrow crosses a box.
COLUMN = {"core": 0.5, "hal": 0.5, "host": 0.27, "firmware": 0.78, "tools": 0.27}
BOX_WIDTH, LINE = 400, 18


def page(width, height, title, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="sans-serif" role="img"><title>{title}</title>'
            f'<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" '
            f'orient="auto"><path d="M0 0 8 4 0 8z" fill="{SOFT}"/></marker></defs>'
            f'<rect width="100%" height="100%" fill="#f6f7f9" rx="12"/>\n' + "\n".join(body) + "\n</svg>\n")


def text(x, y, words, size=14, colour=INK, anchor="middle", weight="normal"):
    return (f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{colour}" text-anchor="{anchor}" '
            f'font-weight="{weight}">{html.escape(words)}</text>')


def box(x, y, width, height, edge=EDGE):
    return (f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="8" fill="{CARD}" '
            f'stroke="{edge}" stroke-width="1.5"/>')


def arrow(x1, y1, x2, y2):
    return (f'<path d="M{x1:g} {y1:g} L{x2:g} {y2:g}" fill="none" stroke="{SOFT}" stroke-width="1.5" '
            f'marker-end="url(#tip)"/>')


def layers_table():
    """Layer -> (folder, libraries, layers it may use), from scripts/check-layers."""
    name = str(ROOT / "scripts" / "check-layers")
    loader = importlib.machinery.SourceFileLoader("check_layers", name)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_layers", loader))
    loader.exec_module(module)
    return module.LAYERS


def folders():
    """({top folder: the folders of its layers}, {top folder: the top folders it uses directly})"""
    layers = layers_table()
    top = {name: folder.split("/")[0] for name, (folder, _, _) in layers.items()}
    rooms = {folder: [] for folder in ABOUT}
    uses = {folder: set() for folder in ABOUT}
    for name, (folder, libraries, allowed) in layers.items():
        room = folder.partition("/")[2]
        rooms[top[name]] += [room] if room else sorted(libraries) if len(libraries) > 1 else []
        uses[top[name]] |= {top[low] for low in allowed} - {top[name]}
    direct = {folder: {low for low in below if not any(low in uses[other] for other in below - {low})}
              for folder, below in uses.items()}
    return {folder: sorted(names) for folder, names in rooms.items()}, direct


def height_of(folder, uses):
    return 1 + max((height_of(low, uses) for low in uses[folder]), default=-1)


def lines_of(names, width=54):
    return textwrap.wrap(", ".join(names), width)


def architecture():
    rooms, uses = folders()
    width, step = 940, 150
    top = max(height_of(folder, uses) for folder in uses)
    place = {folder: (width * COLUMN[folder], 30 + (top - height_of(folder, uses)) * step,
                      56 + LINE * len(lines_of(rooms[folder]))) for folder in uses}
    body = []
    for folder, below in uses.items():
        for low in sorted(below):
            (x1, y1, height), (x2, y2, _) = place[folder], place[low]
            body.append(arrow(x1, y1 + height, x2 + 0.25 * (x1 - x2), y2 - 2))
    for folder, (x, y, height) in place.items():
        body.append(box(x - BOX_WIDTH / 2, y, BOX_WIDTH, height, ACCENT if folder == "core" else EDGE))
        body.append(text(x, y + 24, folder, 16, weight="bold"))
        body.append(text(x, y + 43, ABOUT[folder], 12, SOFT))
        for i, line in enumerate(lines_of(rooms[folder])):
            body.append(text(x, y + 62 + LINE * i, line, 12))
    bottom = max(y + height for _, y, height in place.values())
    return page(width, bottom + 30, "Layers and dependencies: an arrow leads to what is used", body)


def steps_of_a_tick():
    """(from, to, files) of each line of the table."""
    lines = (ROOT / "docs" / "DESIGN.md").read_text().split("## One tick", 1)[1].split("```")[1].splitlines()
    steps = []
    for line in filter(str.strip, lines):
        flow, _, files = line.partition("core/src/")
        begin, end = (part.strip() for part in flow.split("─►"))
        names = files.split("(")[0].strip()
        steps.append((begin, end, names))
    return steps


def tick():
    steps = steps_of_a_tick()
    width, step, left = 940, 72, 250
    body = [box(left, 24, 300, 44), text(left + 150, 52, steps[0][0], 15, weight="bold")]
    for i, (_, end, names) in enumerate(steps):
        y = 24 + (i + 1) * step
        last = i + 1 == len(steps)
        body.append(arrow(left + 150, y - step + 44, left + 150, y - 2))
        body.append(box(left, y, 300, 44, ACCENT if last else EDGE))
        body.append(text(left + 150, y + 28, end, 15, weight="bold"))
        body.append(text(left + 330, y - 10, names, 13, SOFT, "start"))
    return page(width, 24 + len(steps) * step + 68, "One tick: from encoder counts to a motor command", body)
