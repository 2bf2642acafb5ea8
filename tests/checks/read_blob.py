"""An independent reader of blobs, written from docs/FORMAT.md alone: its tests prove the page complete.

usage: read_blob.py BLOB      prints index,x,y,z,nx,ny,nz of every point, like `tactree info --points`
"""
import dataclasses
import math
import struct
import sys
import zlib


@dataclasses.dataclass
class Blob:
    depth: int
    step_m: float
    root_min: tuple
    counts: dict
    nodes: list  # (children that are nodes, children that are leaves)
    directory_level: int
    directory: list
    leaves: list
    points: list
    normals: list
    neighbours: list
    interior: bytes


def refuse_unless(good, rule):
    if not good:
        raise ValueError(f"not a valid blob: {rule}")


def parse(data):
    refuse_unless(data[:8] == b"TACTREE\0", "kBadMagic")
    major, minor, header_bytes, total, checksum = struct.unpack_from("<HHIII", data, 8)
    refuse_unless(major == 1, "kBadVersion")
    refuse_unless(total == len(data), "kBadSize")
    refuse_unless(checksum == zlib.crc32(data[24:], zlib.crc32(data[:20])), "kBadChecksum")
    refuse_unless(header_bytes % 4 == 0 and 344 <= header_bytes <= total, "kBadHeader")
    profile, depth, step = struct.unpack_from("<IIf", data, 24)
    directory_level, group_shift = struct.unpack_from("<2I", data, 80)
    counts = dict(zip(("points", "leaves", "nodes", "materials"), struct.unpack_from("<4I", data, 48)))
    names = ("nodes", "directory", "leaf_bases", "leaf_offsets", "points", "normals", "neighbours",
             "materials", "indices")
    sections = {name: struct.unpack_from("<2I", data, 140 + 8 * i) for i, name in enumerate(names)}
    cursor = header_bytes
    for name in names:
        offset, size = sections[name]
        refuse_unless(offset == cursor, "kBadSections")
        cursor = (cursor + size + 3) // 4 * 4
    refuse_unless(cursor == total, "kBadSections")

    begin, size = struct.unpack_from("<2I", data, 344) if minor >= 1 and header_bytes >= 352 else (0, 0)
    refuse_unless(size in (0, counts["nodes"] + counts["leaves"]), "kBadSections")
    refuse_unless(size == 0 or 352 <= begin <= header_bytes - size and profile == 0, "kBadSections")

    def words(name, letter):
        offset, size = sections[name]
        return struct.unpack_from(f"<{size // struct.calcsize(letter)}{letter}", data, offset)

    nodes = words("nodes", "I")
    nodes = list(zip(nodes[::2], nodes[1::2])) if profile == 1 else nodes
    bases, offsets = words("leaf_bases", "I"), words("leaf_offsets", "H")
    leaves = [bases[i >> group_shift] + offset for i, offset in enumerate(offsets)]
    return Blob(depth, step, struct.unpack_from("<3i", data, 36), counts, nodes, directory_level,
                words("directory", "I"), leaves, words("points", "I"), words("normals", "H"),
                words("neighbours", "I"), data[begin:begin + size])


def children(blob, node, level):
    """(group of nodes, group of leaves) below a node."""
    word = blob.nodes[node]
    if isinstance(word, tuple):
        return word
    return (word, 0) if level + 1 < blob.depth else (0, word)


def walk(blob):
    """(number, level, lower corner) of every leaf, in the order of their numbers."""
    next_leaf, next_node = 0, 1

    def group(word, expected):
        octants = [o for o in range(8) if word >> (24 + o) & 1]
        refuse_unless(word == 0 if not octants else word & 0xFFFFFF == expected, "kBadTree")
        return octants

    def corner(low, octant, level):
        edge = 2048 << (blob.depth - level)
        return tuple(low[axis] + (octant >> axis & 1) * edge for axis in range(3))

    def enter(node, level, low):
        nonlocal next_leaf, next_node
        node_group, leaf_group = children(blob, node, level)
        leaves = group(leaf_group, next_leaf)
        first_leaf, next_leaf = next_leaf, next_leaf + len(leaves)
        inner = group(node_group, next_node)
        first_node, next_node = next_node, next_node + len(inner)
        for i, octant in enumerate(leaves):
            yield first_leaf + i, level + 1, corner(low, octant, level + 1)
        for i, octant in enumerate(inner):
            yield from enter(first_node + i, level + 1, corner(low, octant, level + 1))

    yield from enter(0, 0, blob.root_min)
    refuse_unless(next_leaf == blob.counts["leaves"] and next_node == blob.counts["nodes"], "kBadTree")


def interior(blob, place):
    """(in the material, material behind the surface around it), for a place in lattice units."""
    q = [place[a] - blob.root_min[a] for a in range(3)]
    if not blob.interior or not all(0 <= v < 2048 << blob.depth for v in q):
        return False, False
    node = 0
    for level in range(blob.depth):
        shift = 11 + blob.depth - level - 1
        octant, eighth = (sum((v >> s & 1) << a for a, v in enumerate(q)) for s in (shift, shift - 1))
        marked = bool(blob.interior[node] >> octant & 1)
        nodes, leaves = children(blob, node, level)
        before = (1 << octant) - 1
        if leaves >> 24 >> octant & 1:
            leaf = (leaves & 0xFFFFFF) + bin(leaves >> 24 & before).count("1")
            return bool(blob.interior[blob.counts["nodes"] + leaf] >> eighth & 1), marked
        if not nodes >> 24 >> octant & 1:
            return marked, marked
        refuse_unless(not marked, "kBadTree")
        node = (nodes & 0xFFFFFF) + bin(nodes >> 24 & before).count("1")


def position(blob, word, level, low):
    q = [word >> shift & 1023 for shift in (2, 12, 22)]
    return [blob.step_m * (low[axis] + ((2 * q[axis] + 1) << (blob.depth - level))) for axis in range(3)]


def normal(code):
    u, v = (code & 511) - 255, (code >> 9) - 255
    w = 255 - abs(u) - abs(v)
    if w < 0:
        u, v = (u + w if u >= 0 else u - w), (v + w if v >= 0 else v - w)
    length = math.sqrt(u * u + v * v + w * w)
    return u / length, v / length, w / length


def points(blob):
    """(position, normal) of every point, by index."""
    for number, level, low in walk(blob):
        for i in range(blob.leaves[number], blob.leaves[number + 1]):
            word = blob.points[i]
            yield position(blob, word, level, low), normal((word & 3) << 16 | blob.normals[i])


def cell_of(table, root_min, depth, low, level):
    """Entry of the neighbour table for the cell with that lower corner."""
    edge = 2048 << depth
    if any(not 0 <= low[a] - root_min[a] < edge for a in range(3)):
        return 0xFFFFFFFF
    for above in range(level, 0, -1):
        size = 2048 << (depth - above)
        key = above, tuple(root_min[a] + (low[a] - root_min[a]) // size * size for a in range(3))
        if key in table and (above == level or not table[key] & 0x80000000):
            return table[key]
    return 0xFFFFFFFF


def expected_directory(blob):
    """The directory, computed from the octree alone."""
    level = blob.directory_level
    entries = [0xFFFFFFFF] * (8 ** level if level else 0)

    def enter(node, above, cell):
        if above == level:
            entries[cell[0] | cell[1] << level | cell[2] << 2 * level] = node
            return
        word = children(blob, node, above)[0]
        octants = [o for o in range(8) if word >> (24 + o) & 1]
        for i, octant in enumerate(octants):
            enter((word & 0xFFFFFF) + i, above + 1,
                  tuple(cell[a] << 1 | octant >> a & 1 for a in range(3)))

    if level:
        enter(0, 0, (0, 0, 0))
    return entries


def expected_neighbours(blob):
    """The neighbour table, computed from the octree alone."""
    leaves = sorted(walk(blob))
    table = {(level, low): number | level << 24 for number, level, low in leaves}
    next_node = [1]

    def enter(node, level, low):
        table[level, low] = node | level << 24 | 0x80000000
        octants = [o for o in range(8) if children(blob, node, level)[0] >> (24 + o) & 1]
        first = next_node[0]
        next_node[0] += len(octants)
        edge = 2048 << (blob.depth - level - 1)
        for i, octant in enumerate(octants):
            enter(first + i, level + 1, tuple(low[a] + (octant >> a & 1) * edge for a in range(3)))

    enter(0, 0, blob.root_min)
    for _, level, low in leaves:
        edge = 2048 << (blob.depth - level)
        for axis in range(3):
            for sign in (-1, 1):
                beside = tuple(low[a] + sign * edge * (a == axis) for a in range(3))
                yield cell_of(table, blob.root_min, blob.depth, beside, level)


def main():
    with open(sys.argv[1], "rb") as file:
        blob = parse(file.read())
    print("index,x,y,z,nx,ny,nz")
    for index, (place, direction) in enumerate(points(blob)):
        print(index, *(f"{v:.9g}" for v in (*place, *direction)), sep=",")


if __name__ == "__main__":
    main()
