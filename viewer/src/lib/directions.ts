// SPDX-License-Identifier: Apache-2.0
// Measured directions as vectors, and the index without gaps.

export type Vector = [number, number, number];

/** The unit vector (sin θ cos φ, sin θ sin φ, cos θ), as to_vector of core/direction.hpp. */
export function toVector([theta, phi]: [number, number]): Vector {
  return [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
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
