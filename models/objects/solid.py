"""Closed triangle meshes, for the scripts here that write some. Standard library only."""
import itertools
import math


def icosahedron():
    """Its 12 corners and the 20 faces as triples of them, in either sense."""
    g = (1 + math.sqrt(5)) / 2
    vertices = []
    for s, t in itertools.product((1, -1), repeat=2):
        vertices += [(0, s, t * g), (s, t * g, 0), (t * g, 0, s)]
    edge2 = 4.0
    near = lambda p, q: abs(sum((a - b) ** 2 for a, b in zip(p, q)) - edge2) < 1e-9
    faces = [f for f in itertools.combinations(range(12), 3)
             if all(near(vertices[i], vertices[j]) for i, j in itertools.combinations(f, 2))]
    return vertices, faces


def det(p, q, r):
    return (p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
            + p[2] * (q[0] * r[1] - q[1] * r[0]))


def moments(points, triangles):
    """Volume, centroid and second moments of the solid: sums over tetrahedra from the origin."""
    volume, first, second = 0.0, [0.0] * 3, [[0.0] * 3 for _ in range(3)]
    for t in triangles:
        p = [points[i] for i in t]
        v = det(*p) / 6
        volume += v
        total = [sum(q[c] for q in p) for c in range(3)]
        for c in range(3):
            first[c] += v * total[c] / 4
            for d in range(3):
                second[c][d] += v / 20 * (total[c] * total[d] + sum(q[c] * q[d] for q in p))
    return volume, [m / volume for m in first], second
