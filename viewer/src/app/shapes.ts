// SPDX-License-Identifier: Apache-2.0
// What the material is shown on. Every mesh has texture coordinates in units of its own size,
// so that one unit of u and of v is `size` long on the surface.
import { BufferAttribute, BufferGeometry, PlaneGeometry, TorusKnotGeometry, type Mesh, Vector3 } from 'three';

import { drape } from './cloth';

export type ShapeName = 'sphere' | 'plane' | 'cloth' | 'knot';

/** A sphere about the origin whose texture lies on it without a seam but for one point behind:
 *  azimuthal, equidistant from the point in front. */
function sphere(radius = 1, rings = 128, sectors = 192): BufferGeometry {
  const position: number[] = [];
  const uv: number[] = [];
  const index: number[] = [];
  for (let i = 0; i <= rings; ++i)
    for (let j = 0; j <= sectors; ++j) {
      const [angle, turn] = [(Math.PI * i) / rings, (2 * Math.PI * j) / sectors];
      const [s, c] = [Math.sin(angle), Math.cos(angle)];
      position.push(s * Math.cos(turn), s * Math.sin(turn), c);
      uv.push((angle * Math.cos(turn)) / 2, (angle * Math.sin(turn)) / 2);
    }
  for (let i = 0; i < rings; ++i)
    for (let j = 0; j < sectors; ++j) {
      const a = i * (sectors + 1) + j;
      const b = a + sectors + 1;
      index.push(a, b, b + 1, a, b + 1, a + 1);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(position), 3));
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(position.map((x) => x * radius)), 3));
  geometry.setAttribute('uv', new BufferAttribute(new Float32Array(uv), 2));
  geometry.setIndex(index);
  return geometry;
}

export function makeShape(name: ShapeName): BufferGeometry {
  switch (name) {
    case 'sphere':
      return sphere();
    case 'plane':
      return new PlaneGeometry(2.6, 2.6, 1, 1);
    case 'cloth':
      return drape();
    case 'knot':
      return new TorusKnotGeometry(0.75, 0.27, 400, 64);
  }
}

/** How long one unit of u and of v is, on average over the surface. */
export function uvLengths(geometry: BufferGeometry): [number, number] {
  const position = geometry.getAttribute('position');
  const uv = geometry.getAttribute('uv');
  if (!uv) return [1, 1];
  const corner = (i: number): number => geometry.index?.getX(i) ?? i;
  const count = geometry.index?.count ?? position.count;
  const [p, q, r] = [new Vector3(), new Vector3(), new Vector3()];
  let [alongU, alongV, area] = [0, 0, 0];
  const stride = 3 * Math.max(1, Math.floor(count / 3 / 5000));
  for (let i = 0; i + 2 < count; i += stride) {
    const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
    p.fromBufferAttribute(position, a);
    q.fromBufferAttribute(position, b).sub(p);
    r.fromBufferAttribute(position, c).sub(p);
    const [u1, v1] = [uv.getX(b) - uv.getX(a), uv.getY(b) - uv.getY(a)];
    const [u2, v2] = [uv.getX(c) - uv.getX(a), uv.getY(c) - uv.getY(a)];
    const det = u1 * v2 - u2 * v1;
    if (Math.abs(det) < 1e-12) continue;
    const weight = p.crossVectors(q, r).length();
    const u = new Vector3().addScaledVector(q, v2 / det).addScaledVector(r, -v1 / det).length();
    const v = new Vector3().addScaledVector(q, -u2 / det).addScaledVector(r, u1 / det).length();
    alongU += weight * u;
    alongV += weight * v;
    area += weight;
  }
  return area > 0 ? [alongU / area, alongV / area] : [1, 1];
}

/** Coordinates for meshes that have none: the plane that the mesh is widest in. */
export function ensureUv(mesh: Mesh): void {
  const { geometry } = mesh;
  if (!geometry.getAttribute('normal')) geometry.computeVertexNormals();
  if (geometry.getAttribute('uv')) return;
  const position = geometry.getAttribute('position');
  const uv = new Float32Array(2 * position.count);
  for (let i = 0; i < position.count; ++i) uv.set([position.getX(i), position.getY(i)], 2 * i);
  geometry.setAttribute('uv', new BufferAttribute(uv, 2));
}
