// SPDX-License-Identifier: Apache-2.0
// How fast the viewer is, drawn in software, as JSON with limits: node viewer/tests/bench.mjs
// [MATERIAL.sateen …]. Needs tools/build_viewer.sh and bench/tiles_bench. Times are the shortest of several.
// Processor times are those of the process that draws, from /proc: other programs change them little.
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';

import { launch, PATIENCE, serve } from './browser.mjs';
import { manyMaterial, ROOT, scratch } from './support.mjs';

const ROUNDS = Number(process.env.ROUNDS ?? 12);
const TILES = process.env.TILES_BENCH ?? join(ROOT, 'build/dev/bench/tiles_bench');

const goodbyes = [];
const materials = process.argv.length > 2 ? process.argv.slice(2)
  : [manyMaterial(scratch((end) => goodbyes.push(end)))];
const server = await serve((path) =>
  (path === '/page' ? join(ROOT, 'viewer/dist/viewer.html') : materials.find((m) => `/tests/${basename(m)}` === path) ??
    join(ROOT, 'viewer', path)));
const browser = await launch();
const figures = [];
const add = (material, name, value, unit, limit, details) => figures.push({
  material, name, value: Number(value.toPrecision(4)), unit, at_most: limit, ok: value <= limit, ...details });
const ms = (x) => Number(x.toFixed(1));

/** The fields of /proc/PID/stat after the name: state, parent, … */
function statOf(pid) {
  try {
    return readFileSync(`/proc/${pid}/stat`, 'latin1').split(') ').pop().split(' ');
  } catch {
    return undefined;
  }
}

/** Processes that this one started, and theirs. */
function descendants() {
  const parents = new Map(readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map((pid) => [pid, statOf(pid)?.[1]]));
  const isOurs = (pid) => pid !== undefined && (pid === String(process.pid) || isOurs(parents.get(pid)));
  return [...parents.keys()].filter(isOurs);
}

const TICK_MS = 1000 / Number(spawnSync('getconf', ['CLK_TCK'], { encoding: 'utf8' }).stdout || 100);
let painter;
/** Milliseconds of processor that drawing has taken so far. The process starts with the first page. */
const painted = () => {
  painter ??= descendants().find((pid) => {
    const command = existsSync(`/proc/${pid}/cmdline`) ? readFileSync(`/proc/${pid}/cmdline`, 'latin1') : '';
    return command.includes('--type=gpu-process');
  });
  const stat = statOf(painter);
  return stat ? (Number(stat[11]) + Number(stat[12])) * TICK_MS : 0;
};

for (const material of materials) {
  const name = basename(material);
  // The page itself, from its address to a picture of the material that is on the canvas.
  const page = await browser.newPage({ viewport: { width: 1024, height: 640 } });
  page.setDefaultTimeout(PATIENCE);
  const before = painted();
  await page.goto(`${server.origin}/page?url=tests/${name}`, { waitUntil: 'commit' });
  const shown = await (await page.waitForFunction(() => document.body?.dataset.ready === 'true' && performance.now())
  ).jsonValue();
  const paintedPage = painted() - before;
  await page.close();

  const library = await browser.newPage();
  library.setDefaultTimeout(PATIENCE);
  await library.goto(`${server.origin}/tests/bench.html`);
  await library.waitForFunction(() => document.body.dataset.ready === 'true');
  const run = await library.evaluate(([url, rounds]) => window.bench(url, rounds), [name, ROUNDS]);
  const paintedFrames = {};
  for (const kind of ['sateen', 'standard']) {
    const from = painted();
    await library.evaluate(([k, rounds]) => window.drawFrames(k, rounds), [kind, ROUNDS]);
    paintedFrames[kind] = (painted() - from) / ROUNDS;
  }
  await library.close();

  add(name, 'from address to a lit picture', shown / 1000, 's', 3,
    { library_ms: ms(run.firstPicture), loaded_ms: ms(run.loaded), created_ms: ms(run.created), painter_ms: ms(paintedPage), subspaces: run.subspaces });
  add(name, 'frame, sphere of 480 x 480, to MeshStandardMaterial with two maps', run.own / run.theirs, 'x', 4,
    { frame_ms: ms(run.own), standard_ms: ms(run.theirs), without_displacement_ms: ms(run.shaded), relief: run.relief });
  add(name, 'processor time of that frame, to MeshStandardMaterial with two maps', paintedFrames.sateen / paintedFrames.standard, 'x', 4,
    { frame_ms: ms(paintedFrames.sateen), standard_ms: ms(paintedFrames.standard) });
  if (!existsSync(TILES)) continue;
  const native = spawnSync(TILES, [material, '256'], { encoding: 'utf8' });
  if (native.status !== 0) throw new Error(native.stderr);
  const alone = JSON.parse(native.stdout).ms;
  add(name, 'textures of 256 x 256 in the worker, to native on one thread', run.drawing / alone, 'x', 4,
    { worker_ms: ms(run.drawing), native_ms: ms(alone) });
}
await browser.close();
server.close();
goodbyes.forEach((end) => end());
console.log(JSON.stringify({ bench: 'viewer', figures }, null, 1));
