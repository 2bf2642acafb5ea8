"""Tables of docs/FORMAT.md and docs/PROTOCOL.md from the headers of core: offset, size, type, code and value of
every field, enumerator and constant. Units and meanings are kept from the page; a new row gets them from the name
and the comment in the header.
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile

TYPES = {"std::uint8_t": "u8", "std::uint16_t": "u16", "std::uint32_t": "u32", "std::int32_t": "i32",
         "float": "f32", "char": "char", "BlobSection": "section", "BlobDouble": "f64", "ModelSlot": "slot"}
UNITS = (("_N_s", "N/s"), ("_Ns_m", "Ns/m"), ("_N_m", "N/m"), ("_rad_s", "rad/s"), ("_m_s", "m/s"), ("_bytes", "byte"),
         ("_ticks", "tick"), ("_us", "us"), ("_ms", "ms"), ("_hz", "Hz"), ("_N", "N"), ("_m", "m"), ("_s", "s"), ("_V", "V"))


class Headers:
    """The declarations of some headers; values and offsets come from a compiled program."""

    def __init__(self, root, files, include, namespace, enums_of=()):
        self.include = root / "core/include"
        self.comments = {}
        text = "".join(self.read(self.include / file) for file in files)
        self.structs, self.constants = self.read_structs(text), re.findall(
            r"\binline constexpr (?:std::uint8_t\s+(?=k\w+\[)|[\w:]+\s+(?=k\w+\s*=))(k\w+)", text)
        self.enums = self.read_enums(text)
        for file, name in enums_of:
            self.enums[name] = self.read_enums(self.read(self.include / file))[name]
        self.values = self.ask_compiler(include, namespace)

    def read(self, path):
        """Without comments; those behind a declaration are kept by its name."""
        text = path.read_text().split("class FrameDecoder")[0]
        for name, comment in re.findall(r"\b(\w+)(?:\[\w+\])?(?: = [^;,\n]+|\{\})?[;,] *///< ([^\n]*(?:\n +///< [^\n]*)*)", text):
            self.comments.setdefault(name, re.sub(r"\n +///<", "", comment))
        return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)

    @staticmethod
    def read_structs(text):
        """{struct: [(field, type as documented)]}"""
        structs = {}
        for name, body in re.findall(r"\bstruct (\w+)\s*\{((?:[^{}]|\{[^{}]*\})*)\};", text):
            body = re.sub(r"\s*=\s*\{[^}]*\}|\{\s*\}|\s*=\s*[^;{]+(?=;)", "", body)
            fields = []
            for declaration in filter(None, (part.strip() for part in body.split(";"))):
                match = re.fullmatch(r"([\w:]+)\s+(\w+)(\[\w+\])?", declaration)
                if not match or match[1] not in TYPES:
                    raise SystemExit(f'generate: cannot read the declaration "{declaration}" of {name}')
                fields.append((match[2], TYPES[match[1]] + (match[3] or "")))
            structs[name] = fields
        return structs

    @staticmethod
    def read_enums(text):
        return {name: re.findall(r"\b(k\w+)\b", body)
                for name, body in re.findall(r"\benum class (\w+)[^{;]*\{(.*?)\};", text, re.DOTALL)}

    def ask_compiler(self, include, namespace):
        lines = ["#include <cstddef>", "#include <cstdio>", "#include <type_traits>", f'#include "{include}"',
                 f"using namespace {namespace};",
                 "template <class T> void show(const char* n, const T& v) {",
                 "  if constexpr (std::is_array_v<T>) {",
                 '    std::printf("{\\"%s\\": \\"", n);',
                 '    for (unsigned i = 0; i < sizeof v; ++i) std::printf(i ? " %02X" : "%02X", v[i]);',
                 '    std::printf("\\"}\\n");',
                 '  } else std::printf("{\\"%s\\": %lld}\\n", n, static_cast<long long>(v));',
                 "}", "int main() {"]
        for struct, fields in self.structs.items():
            lines.append(f'show("{struct}", sizeof({struct}));')
            for field, _ in fields:
                lines.append(f'show("{struct}.{field}.offset", offsetof({struct}, {field}));')
                lines.append(f'show("{struct}.{field}.size", sizeof({struct}::{field}));')
        lines += [f'show("{enum}.{name}", {enum}::{name});' for enum, names in self.enums.items() for name in names]
        lines += [f'show("{name}", {name});' for name in self.constants]
        with tempfile.TemporaryDirectory() as folder:
            source, program = pathlib.Path(folder, "show.cpp"), pathlib.Path(folder, "show")
            source.write_text("\n".join([*lines, "}"]))
            subprocess.run([os.environ.get("CXX", "c++"), "-std=c++20", "-I", self.include, source, "-o", program],
                           check=True)
            output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
        values = {}
        for line in output.splitlines():
            values.update(json.loads(line))
        return values

    # Rows: (the cell that names it, the cells that are generated, cells where the page has none).

    def field_rows(self, struct):
        for name, kind in self.structs[struct]:
            at = f"{struct}.{name}"
            unit = next((unit for end, unit in UNITS if name.endswith(end)), "-")
            yield f"`{name}`", [self.values[at + ".offset"], self.values[at + ".size"], kind, f"`{name}`"], [
                unit, self.comments.get(name, name.replace("_", " "))]

    def enum_rows(self, enum):
        for name in self.enums[enum]:
            yield f"`{name}`", [self.values[f"{enum}.{name}"], f"`{name}`"], [self.comments.get(name, "-")]

    def constant_rows(self):
        for name in self.constants:
            value = self.values[name]
            value = value & 0xFFFFFFFF if isinstance(value, int) else f"`{value}`"
            yield f"`{name}`", [f"`{name}`", value], [self.comments.get(name, "-")]


def number(text):
    return int(text, 0) if isinstance(text, str) and re.fullmatch(r"0[xX][0-9A-Fa-f]+|-?\d+", text) else text


def replace_table(page, heading, title, rows):
    """The table below the heading that matches, which becomes `title`, with new rows."""
    found = re.search(rf"(?m)^#+ {heading}[^\n]*\n(?:(?!\||#).*\n)*((?:\|.*\n)+)", page)
    if not found:
        raise SystemExit(f"generate: the page has no table below a heading {heading} (add one)")
    head, rule, *old = found[1].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in old]
    lines = [head, rule]
    for key, generated, default in rows:
        row = next((row for row in cells if key in row), None)
        if row is None:
            kept = default
        else:
            kept = row[len(generated):]
            # The page's own notation of an equal number: 0x0A.
            generated = [mine if number(mine) == new else new for mine, new in zip(row, generated)]
        lines.append("| " + " | ".join(map(str, [*generated, *kept])) + " |")
    whole = found[0]
    new = whole.replace(found[1], "\n".join(lines) + "\n")
    if title:
        new = re.sub(r"^(#+) [^\n]*", rf"\1 {title}", new)
    return page.replace(whole, new)


def rewrite(page, headers):
    for struct in headers.structs:
        page = replace_table(page, f"`{struct}`", f"`{struct}`, {headers.values[struct]} bytes",
                             headers.field_rows(struct))
    for enum in headers.enums:
        page = replace_table(page, f"`{enum}`", None, headers.enum_rows(enum))
    return replace_table(page, "Constants", None, headers.constant_rows())


def format_page(page, root):
    model = "tactree/core/model/"
    return rewrite(page, Headers(root, [model + "blob_format.hpp"], model + "blob.hpp", "tactree::core",
                                 [(model + "blob.hpp", "BlobStatus")]))


def protocol_page(page, root):
    wire = "tactree/core/link/wire/"
    return rewrite(page, Headers(root, [wire + "frame.hpp", wire + "messages.hpp"], wire + "messages.hpp",
                                 "tactree::core::wire"))
