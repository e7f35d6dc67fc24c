"""Surface nets on a grid that is finer in some boxes."""
import numpy as np


class _Cells:
    """Numbers of the cells that the surface may cross, and the mean of the points where it crosses their edges."""

    def __init__(self):
        self.rings, self.points = [], []

    def add(self, around, point, flip):
        around[flip] = around[flip][:, ::-1]
        self.rings.append(around)
        self.points.append(point)

    def mesh(self):
        rings, points = np.concatenate(self.rings), np.concatenate(self.points)
        names, index = np.unique(rings.reshape(-1), return_inverse=True)
        rings = index.reshape(rings.shape)
        total, count = np.zeros((len(names), 3)), np.zeros(len(names))
        for k in range(4):
            np.add.at(total, rings[:, k], points)
            np.add.at(count, rings[:, k], 1)
        triangles = np.concatenate([rings[:, [0, 1, 2]], rings[:, [0, 2, 3]]])
        # Between a fine and a coarse cell a ring has three corners.
        a, b, c = triangles.T
        return total / count[:, None], triangles[(a != b) & (b != c) & (c != a)]


def _edges(values, axis):
    """Grid points (off the lower faces) at which edges along `axis` that the surface crosses begin, where, and which way."""
    inside = values < 0
    n = np.array(values.shape)
    first = [slice(None)] * 3
    second = [slice(None)] * 3
    first[axis], second[axis] = slice(0, n[axis] - 1), slice(1, n[axis])
    edge = np.argwhere(inside[tuple(first)] != inside[tuple(second)])
    unit = np.eye(3, dtype=int)[axis]
    va, vb = values[tuple(edge.T)], values[tuple((edge + unit).T)]
    return edge, edge + (va / (va - vb))[:, None] * unit, va >= 0


def surface_nets(field, low, counts, step, boxes=()):
    """Vertices and triangles of the surface field = 0 on `counts` points from `low` on. `boxes`: (first, last cell, parts): cells
    there are divided into that many along each axis. One vertex a cell that the surface crosses; cells of different sizes meet
    without a gap, since the edges that both touch are the fine ones."""
    def sample(origin, shape, h):
        grid = np.stack(np.meshgrid(*[origin[k] + h * np.arange(shape[k]) for k in range(3)], indexing="ij"), axis=-1)
        return np.concatenate([field(slab) for slab in np.array_split(grid, 16)])

    n = np.array(counts) - 1
    fine = np.zeros(n, bool)
    for first, last, _ in boxes:
        fine[tuple(slice(a, b) for a, b in zip(first, last))] = True
    number = np.arange(n.prod()).reshape(n)
    cells, offset = _Cells(), int(n.prod())

    values = sample(low, counts, step)
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        edge, at, outside = _edges(values, axis)
        ring = np.stack([edge - du * u - dv * v for du, dv in ((1, 1), (0, 1), (0, 0), (1, 0))], axis=1)
        kept = ((ring >= 0) & (ring < n)).all(axis=(1, 2))
        ring, at, outside = ring[kept], at[kept], outside[kept]
        kept = ~fine[tuple(ring.transpose(2, 0, 1))].any(axis=1)
        ring, at, outside = ring[kept], at[kept], outside[kept]
        cells.add(number[tuple(ring.transpose(2, 0, 1))], low + step * at, outside)

    for first, last, parts in boxes:
        first, size = np.array(first), (np.array(last) - first) * parts
        values = sample(low + step * first, size + 1, step / parts)
        for axis in range(3):
            u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
            edge, at, outside = _edges(values, axis)
            ring = np.stack([edge - du * u - dv * v for du, dv in ((1, 1), (0, 1), (0, 0), (1, 0))], axis=1)
            within = ((ring >= 0) & (ring < size)).all(axis=2)
            own = offset + (ring * [size[1] * size[2], size[2], 1]).sum(axis=2)
            coarse = np.clip(ring // parts + first, 0, n - 1)
            around = np.where(within, own, number[tuple(coarse.transpose(2, 0, 1))])
            cells.add(around, low + step * (first + at / parts), outside)
        offset += int(size.prod())
    return cells.mesh()
