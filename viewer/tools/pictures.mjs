// SPDX-License-Identifier: Apache-2.0
// Pictures of the page: node viewer/tools/pictures.mjs < LIST.json, an array of
//     {"file": "a.png", "width": 1000, "height": 600, "materials": ["A.sateen", "B.sateen"], "shape": "cloth",
//      "mode": "relief", "set": {"scale": 1}, "press": ["#toggle"], "phone": true, "dark": true, "bare": true}
// all but the first three may be left out. Needs tools/build_viewer.sh and Chromium, which draws in software.
import { join } from 'node:path';
import { readFileSync } from 'node:fs';

import { closeWatched, launch, serve, watchedPage } from '../tests/browser.mjs';
import { ROOT } from '../tests/support.mjs';

const list = JSON.parse(readFileSync(0, 'utf8'));
const paths = [...new Set(list.flatMap(({ materials = [] }) => materials))];
const addressOf = (path) => `/${paths.indexOf(path)}.sateen`;
const server = await serve((address) =>
  (address === '/' ? join(ROOT, 'viewer/dist/viewer.html') : paths.find((path) => addressOf(path) === address)));
const browser = await launch();

/** As if dropped on the page: two materials are compared. */
const drop = (page, addresses) => page.evaluate(async (all) => {
  const transfer = new DataTransfer();
  for (const address of all) transfer.items.add(new File([await (await fetch(address)).blob()], address));
  dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
}, addresses);

/** One picture of the page, as a user would bring it about. */
async function take({ file, width, height, materials = [], shape, mode, set = {}, press = [], phone, dark, bare }) {
  const watched = await watchedPage(browser, {
    viewport: { width, height }, deviceScaleFactor: 1, isMobile: phone, hasTouch: phone,
    colorScheme: dark ? 'dark' : 'light', reducedMotion: 'reduce',
  });
  const { page } = watched;
  const choose = (name, value) => value && page.$eval(`input[name="${name}"][value="${value}"]`, (input) => input.click());
  await page.goto(`${server.origin}/`);
  await page.waitForFunction(() => document.body.dataset.started === 'true');
  // Chosen before there is anything to draw: frames in software are slow.
  await choose('shape', shape);
  for (const [id, value] of Object.entries(set))
    await page.$eval(`#${id}`, (input, v) => {
      input.value = v;
      for (const kind of ['input', 'change']) input.dispatchEvent(new Event(kind, { bubbles: true }));
    }, value);
  if (bare) await page.addStyleTag({ content: 'header, .hint, #toggle { display: none !important }' });
  for (const selector of press) await page.$eval(selector, (control) => control.click());
  await drop(page, materials.map(addressOf));
  await page.waitForSelector(['#welcome:not([hidden])', 'body[data-ready="true"]', '#divider:not([hidden])'][materials.length],
    { state: 'attached' });
  await choose('mode', mode);
  await page.screenshot({ path: file });
  await closeWatched(watched, server.origin);
}

for (const wanted of list) await take(wanted);
await browser.close();
server.close();
