// SPDX-License-Identifier: Apache-2.0
// The triangulation of measured directions, and the map by which a shader finds the triangle
// that a direction lies in.

export type Vector = [number, number, number];
export type Triangle = [number, number, number];

/** The unit vector (sin θ cos φ, sin θ sin φ, cos θ), as to_vector of core/direction.hpp. */
export function toVector([theta, phi]: [number, number]): Vector {
  return [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
}

/** Directions beyond so many are not triangulated: no measurement has them. */
const MAX_TRIANGULATED = 4096;

/**
 * Delaunay triangulation on the sphere, by Bowyer and Watson in stereographic projection from
 * (0, 0, -1), which maps circles to circles. O(n²).
 */
export function triangulate(directions: Vector[]): Triangle[] {
  // Rings of directions are cocircular; what breaks the ties must not depend on rounding.
  const points = directions.slice(0, MAX_TRIANGULATED).map(([x, y, z], i) => {
    const jitter = 1e-6 * Math.sin(12.9898 * i + 1);
    return [x / (1 + z) + jitter, y / (1 + z) + 0.7 * jitter] as const;
  });
  const n = points.length;
  const all = [...points, [-50, -50], [50, -50], [0, 80]] as (readonly [number, number])[];
  let triangles: Triangle[] = [[n, n + 1, n + 2]];
  for (let p = 0; p < n; ++p) {
    const borders = new Map<string, [number, number]>();
    const kept: Triangle[] = [];
    for (const t of triangles) {
      if (!inCircle(all[p]!, t.map((i) => all[i]!) as [P, P, P])) {
        kept.push(t);
        continue;
      }
      for (const [a, b] of [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] as [number, number][])
        if (!borders.delete(`${b},${a}`)) borders.set(`${a},${b}`, [a, b]);
    }
    for (const [a, b] of borders.values()) kept.push([a, b, p]);
    triangles = kept;
  }
  return triangles.filter((t) => t.every((i) => i < n));
}

type P = readonly [number, number];

/** Whether p is inside the circle through three points in counter-clockwise order. */
function inCircle(p: P, [a, b, c]: [P, P, P]): boolean {
  const [ax, ay, bx, by, cx, cy] =
    [a[0] - p[0], a[1] - p[1], b[0] - p[0], b[1] - p[1], c[0] - p[0], c[1] - p[1]];
  return (ax * ax + ay * ay) * (bx * cy - cx * by) - (bx * bx + by * by) * (ax * cy - cx * ay) +
    (cx * cx + cy * cy) * (ax * by - bx * ay) > 0;
}

/** w with w₀ a + w₁ b + w₂ c ∝ d and Σ w = 1; undefined where the three lie in a plane. */
export function barycentric(d: Vector, a: Vector, b: Vector, c: Vector): Vector | undefined {
  const w: Vector = [det(d, b, c), det(a, d, c), det(a, b, d)];
  const sum = w[0] + w[1] + w[2];
  return Math.abs(sum) < 1e-9 ? undefined : [w[0] / sum, w[1] / sum, w[2] / sum];
}

function det(a: Vector, b: Vector, c: Vector): number {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/**
 * The triangle of each cell of the hemisphere, (side, side, 4) numbers of directions. A cell at
 * (s, t) ∈ [-1, 1]² is the direction whose hemi-octahedral coordinates are
 * (x + y, x - y) / (|x| + |y| + z): the shader's direction_cell.
 * Directions outside all triangles have the one that they are the least outside of.
 */
export function directionMap(directions: Vector[], side: number): Uint16Array {
  const map = new Uint16Array(side * side * 4);
  const triangles = directions.length < 3 ? [] : triangulate(directions);
  const corners = triangles.map((t) => t.map((i) => directions[i]!) as [Vector, Vector, Vector]);
  for (let row = 0; row < side; ++row)
    for (let col = 0; col < side; ++col) {
      const d = cellDirection((2 * (col + 0.5)) / side - 1, (2 * (row + 0.5)) / side - 1);
      let best = -1;
      let depth = -Infinity;
      for (let t = 0; t < triangles.length && depth < 0; ++t) {
        const w = barycentric(d, ...corners[t]!);
        const least = w ? Math.min(...w) : -Infinity;
        if (w && least > depth) [best, depth] = [t, least];
      }
      map.set(best < 0 ? nearestThrice(d, directions) : triangles[best]!, 4 * (row * side + col));
    }
  return map;
}

function cellDirection(s: number, t: number): Vector {
  const [x, y] = [(s + t) / 2, (s - t) / 2];
  const z = Math.max(0, 1 - Math.abs(x) - Math.abs(y));
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

function nearestThrice(d: Vector, directions: Vector[]): Triangle {
  let best = 0;
  let closeness = -2;
  directions.forEach((e, i) => {
    const cosine = d[0] * e[0] + d[1] * e[1] + d[2] * e[2];
    if (cosine > closeness) [best, closeness] = [i, cosine];
  });
  return [best, best, best];
}

/** The index with every pair: what was not measured has the subspace of the nearest pair. */
export function completeIndex(index: number[], views: Vector[], lights: Vector[]): Uint8Array {
  const complete = new Uint8Array(index.length);
  const measured: number[] = [];
  index.forEach((k, i) => k >= 0 && measured.push(i));
  const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  index.forEach((k, i) => {
    if (k >= 0) {
      complete[i] = k;
      return;
    }
    const [light, view] = [lights[Math.floor(i / views.length)]!, views[i % views.length]!];
    let closeness = -3;
    for (const j of measured) {
      const c = dot(light, lights[Math.floor(j / views.length)]!) + dot(view, views[j % views.length]!);
      if (c > closeness) [closeness, complete[i]] = [c, index[j]!];
    }
  });
  return complete;
}
