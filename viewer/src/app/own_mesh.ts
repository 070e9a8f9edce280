// SPDX-License-Identifier: Apache-2.0
// An object of the user's: glTF with everything inside, or OBJ.
import { Group, Mesh } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';

import { ensureUv } from './shapes';

export async function readMesh(file: File): Promise<Group> {
  const object = /\.obj$/i.test(file.name)
    ? new OBJLoader().parse(await file.text())
    : (await new GLTFLoader().parseAsync(await file.arrayBuffer(), '')).scene;
  let meshes = 0;
  object.traverse((o) => {
    if (!(o instanceof Mesh)) return;
    ensureUv(o);
    ++meshes;
  });
  if (meshes === 0) throw new Error('no surface in it, expected triangles');
  return object;
}
