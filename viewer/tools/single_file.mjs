// SPDX-License-Identifier: Apache-2.0
// Turns dist/ into one page, dist/viewer.html, that opens from a disk: styles in place, the
// program packed by gzip and started from memory.
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const dist = new URL('../dist/', import.meta.url);
const read = (path) => readFileSync(new URL(path, dist), 'utf8');
let html = read('index.html');

for (const [tag, path] of html.matchAll(/<link rel="stylesheet"[^>]*href="([^"]+)"[^>]*>/g)) {
  const css = read(path);
  html = html.replace(tag, () => `<style>${css}</style>`);
}

const scripts = [...html.matchAll(/<script type="module"[^>]*src="([^"]+)"[^>]*><\/script>/g)];
const bundles = readdirSync(new URL('assets/', dist)).filter((name) => name.endsWith('.js'));
if (scripts.length !== 1 || bundles.length !== 1)
  throw new Error(`expected one script in one file, found ${scripts.length} in ${bundles.join(', ')}`);
html = html.replace(scripts[0][0], '');
const packed = gzipSync(read(scripts[0][1]), { level: 9 }).toString('base64');
const START = `
const packed = Uint8Array.from(atob(document.getElementById('program').textContent), (c) => c.charCodeAt(0));
const text = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).blob();
await import(URL.createObjectURL(new Blob([text], { type: 'text/javascript' })));`;
html = html.replace('</body>', () =>
  `<script type="text/plain" id="program">${packed}</script>\n<script type="module">${START}\n</script>\n</body>`);
if (!html.includes('<!--sateen-material-->')) throw new Error('the place of the material is gone');
writeFileSync(new URL('viewer.html', dist), html);
console.log(`dist/viewer.html: ${(html.length / 1000).toFixed(0)} KB`);
