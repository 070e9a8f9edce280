// SPDX-License-Identifier: Apache-2.0
// A square cloth that has fallen over a ball: positions under constraints (Müller et al. 2007).
import { BufferAttribute, PlaneGeometry, type BufferGeometry } from 'three';

const SIDE = 88;
const LENGTH = 3.1;
const RADIUS = 0.8;
const FLOOR = -1.0;
const STEPS = 260;

/** Always the same cloth. Takes about a third of a second. */
export function drape(): BufferGeometry {
  const n = SIDE + 1;
  const rest = LENGTH / SIDE;
  const x = new Float32Array(3 * n * n);
  for (let r = 0; r < n; ++r)
    for (let c = 0; c < n; ++c)
      x.set([(c - SIDE / 2) * rest + 0.11, RADIUS + 0.02 + 0.002 * Math.sin(1.7 * r + 2.3 * c),
        (r - SIDE / 2) * rest - 0.07], 3 * (r * n + c));
  const old = x.slice();
  const links: [number, number, number][] = [];
  const link = (r: number, c: number, dr: number, dc: number): void => {
    if (r + dr < n && c + dc < n && c + dc >= 0)
      links.push([3 * (r * n + c), 3 * ((r + dr) * n + c + dc), rest * Math.hypot(dr, dc)]);
  };
  for (let r = 0; r < n; ++r)
    for (let c = 0; c < n; ++c)
      for (const [dr, dc] of [[0, 1], [1, 0], [1, 1], [1, -1], [0, 3], [3, 0]] as const) link(r, c, dr, dc);
  for (let step = 0; step < STEPS; ++step) {
    for (let i = 0; i < x.length; ++i) {
      const speed = (x[i]! - old[i]!) * 0.975;
      old[i] = x[i]!;
      x[i]! += speed - (i % 3 === 1 ? 0.0011 : 0);
    }
    for (let round = 0; round < 5; ++round) for (const l of links) hold(x, l);
    collide(x, old);
  }
  const geometry = new PlaneGeometry(LENGTH, LENGTH, SIDE, SIDE);
  const position = geometry.getAttribute('position') as BufferAttribute;
  position.copyArray(x);
  geometry.computeVertexNormals();
  return geometry;
}

function hold(x: Float32Array, [a, b, rest]: [number, number, number]): void {
  const [dx, dy, dz] = [x[b]! - x[a]!, x[b + 1]! - x[a + 1]!, x[b + 2]! - x[a + 2]!];
  const length = Math.sqrt(dx * dx + dy * dy + dz * dz) || 1e-6;
  const half = (0.48 * (length - rest)) / length;
  x[a]! += dx * half;
  x[a + 1]! += dy * half;
  x[a + 2]! += dz * half;
  x[b]! -= dx * half;
  x[b + 1]! -= dy * half;
  x[b + 2]! -= dz * half;
}

/** Out of the ball and above the floor, with friction on both. */
function collide(x: Float32Array, old: Float32Array): void {
  for (let i = 0; i < x.length; i += 3) {
    const length = Math.hypot(x[i]!, x[i + 1]!, x[i + 2]!);
    const inside = length < RADIUS;
    if (inside) for (let j = 0; j < 3; ++j) x[i + j]! *= RADIUS / length;
    const below = x[i + 1]! < FLOOR;
    if (below) x[i + 1] = FLOOR;
    if (inside || below) for (let j = 0; j < 3; ++j) old[i + j]! += 0.4 * (x[i + j]! - old[i + j]!);
  }
}
