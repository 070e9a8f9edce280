// SPDX-License-Identifier: Apache-2.0
// Headless Chromium that draws in software, and a server of files on loopback.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { chromium } from 'playwright-core';

const BROWSER = process.env.CHROMIUM ?? '/usr/bin/chromium';
/** Milliseconds: a software renderer on a busy machine is slow, and none of the tests is about time. */
export const PATIENCE = 300_000;

export function launch() {
  assert.ok(existsSync(BROWSER), `${BROWSER} is missing`);
  return chromium.launch({
    executablePath: BROWSER,
    timeout: PATIENCE,
    args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader'],
  });
}

const TYPES = { html: 'text/html', js: 'text/javascript', css: 'text/css' };

/** Serves files by their address. @param find  address to the path of a file, or undefined */
export async function serve(find) {
  const server = createServer((request, response) => {
    const path = find(new URL(request.url, 'http://localhost').pathname);
    if (!path || !existsSync(path)) {
      response.writeHead(404).end();
      return;
    }
    response.setHeader('Content-Type', TYPES[path.split('.').pop()] ?? 'application/octet-stream');
    response.end(readFileSync(path));
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { origin: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

/** A page that remembers what it complained of and asked for. */
export async function watchedPage(browser, options) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  const complaints = [];
  const requests = [];
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(m.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  return { context, page, complaints, requests };
}

/** Closes it. It must have kept silent, and asked nobody but its own origin. */
export async function closeWatched({ context, complaints, requests }, origin) {
  await context.close();
  // SwiftShader says that reading pixels is slow.
  assert.deepEqual(complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text)), []);
  for (const url of requests)
    assert.ok(url.startsWith(origin) || /^(blob|data|file):/.test(url), `a request to ${url}`);
}

/** Pixels of the canvas, RGBA, after it has been drawn; the middle `side` × `side` of them if given. */
export function pixelsOf(page, side = 0) {
  return page.evaluate((wanted) => new Promise((resolve) => {
    requestAnimationFrame(() => requestAnimationFrame(() => {
      const source = document.querySelector('canvas');
      const [width, height] = [wanted || source.width, wanted || source.height];
      const draw = new OffscreenCanvas(width, height).getContext('2d');
      draw.drawImage(source, (source.width - width) / 2, (source.height - height) / 2, width, height, 0, 0, width, height);
      resolve({ width, height, data: Array.from(draw.getImageData(0, 0, width, height).data) });
    }));
  }), side);
}
