// SPDX-License-Identifier: Apache-2.0
// Writes src/lib/wasm.ts: the WebAssembly runtime as text, so that a bundle is whole.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const here = (path) => new URL(path, import.meta.url);
const source = here('../../build/wasm/bin/sateen.wasm');
if (!existsSync(source)) {
  console.error('build/wasm/bin/sateen.wasm is missing: run tools/build_wasm.sh first');
  process.exit(1);
}
const packed = gzipSync(readFileSync(source), { level: 9 });
writeFileSync(
  here('../src/lib/wasm.ts'),
  `// Made by tools/embed_wasm.mjs.\nexport default '${packed.toString('base64')}';\n`);
