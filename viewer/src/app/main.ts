// SPDX-License-Identifier: Apache-2.0
// The viewer: opens materials, and connects the controls to the stage.
import { Color } from 'three';

import { loadMaterial, type Material } from '../lib/material';
import { SateenMaterial, subspaceColours, type ViewMode } from '../lib/sateen_material';
import { bindLampPad, bindPointer, type LampDirection } from './pointer';
import type { ShapeName } from './shapes';
import { Stage, SURROUNDINGS } from './stage';

const get = <E extends HTMLElement>(id: string): E => document.getElementById(id) as E;

/** Texels along the length 1, the radius of the sphere, where the pattern has its usual size. */
const USUAL_SCALE = 300;
const TILE = 256;

interface Shown {
  name: string;
  bytes: number;
  material: SateenMaterial;
}

/** `?reference=VIEW,LIGHT,…` shows what `sateen render` draws of a plane, for comparison with it. */
const QUERY = new URLSearchParams(location.search);
const REFERENCE = QUERY.get('reference');

/** Directions in degrees (view theta, phi, light theta, phi), repeats of the tile, 1 for displacement. */
function showReference(text: string): void {
  const [viewTheta = 0, viewPhi = 0, lightTheta = 0, lightPhi = 0, repeats = 1, marched = 0] = text.split(',').map(Number);
  const radians = (theta: number, phi: number): [number, number] => [(theta * Math.PI) / 180, (phi * Math.PI) / 180];
  if (shown.main) shown.main.material.marched = marched === 1;
  stage.showReference(radians(viewTheta, viewPhi), radians(lightTheta, lightPhi), repeats, TILE);
}

const stage = new Stage(get<HTMLCanvasElement>('canvas'));
const shown: { main?: Shown; other?: Shown } = {};
let opening: AbortController | undefined;

// ---------------------------------------------------------------- messages

let messageTimer = 0;
function say(text: string): void {
  const message = get('message');
  message.textContent = text;
  message.hidden = text === '';
  clearTimeout(messageTimer);
  if (text) messageTimer = window.setTimeout(() => say(''), 12000);
}

function showProgress(share: number | undefined): void {
  const bar = get('progress');
  bar.hidden = share === undefined;
  const percent = Math.round(100 * (share ?? 0));
  bar.setAttribute('aria-valuenow', String(percent));
  (bar.firstElementChild as HTMLElement).style.width = `${percent}%`;
}

// ---------------------------------------------------------------- opening

async function open(source: string | Blob | Uint8Array, name: string, compare = false): Promise<void> {
  opening?.abort();
  const { signal } = (opening = new AbortController());
  say('');
  showProgress(0.02);
  let loaded: Material | undefined;
  try {
    loaded = await loadMaterial(source);
    const material = await SateenMaterial.create(loaded, {
      tile: TILE, repeat: REFERENCE !== null, anisotropy: stage.anisotropy, onProgress: showProgress, signal,
      prepare: (coming) => stage.prepare(coming),
    });
    const next = { name: loaded.description.name || name, bytes: loaded.bytes, material };
    const slot = compare ? 'other' : 'main';
    shown[slot]?.material.dispose();
    shown[slot] = next;
    applyShown();
  } catch (error) {
    if (!signal.aborted) say(`${name}: ${error instanceof Error ? error.message : String(error)}`);
  } finally {
    loaded?.dispose();
    if (!signal.aborted) showProgress(undefined);
  }
}

function applyShown(): void {
  const { main, other } = shown;
  get('welcome').hidden = main !== undefined;
  stage.material = main?.material;
  stage.split = main && other ? { material: other.material, at: stage.split?.at ?? 0.5 } : undefined;
  get('compare').setAttribute('aria-pressed', String(stage.split !== undefined));
  get('compare').textContent = stage.split ? 'Compare ×' : 'Compare…';
  get('divider').hidden = get('names').hidden = stage.split === undefined;
  if (main) {
    const { description } = main.material;
    document.title = `${main.name} – Sateen`;
    get('name').textContent = main.name;
    get('name-left').textContent = main.name;
    get('name-right').textContent = other?.name ?? '';
    const pairs = description.views.length * description.lights.length;
    const from = pairs > 0 ? `${description.views.length} views × ${description.lights.length} lights` : 'photograph';
    get('facts').textContent = `${size(main.bytes)} · ${from}`;
  }
  const measured = (main?.material.description.views.length ?? 0) > 0;
  disable('input[value="index"]', !measured);
  const rough = main?.material.hasSurface ?? false;
  disable('input[value="relief"], input[value="smooth"], #relief', !rough);
  get('table').hidden = !measured;
  if (main && measured) drawIndex(main.material);
  applyLook();
  placeDivider();
  document.body.dataset.ready = main ? 'true' : 'false';
}

function disable(selector: string, disabled: boolean): void {
  for (const input of document.querySelectorAll<HTMLInputElement>(selector)) {
    input.disabled = disabled;
    if (disabled && input.checked) get<HTMLInputElement>('modes').querySelector('input')!.checked = true;
  }
}

const size = (bytes: number): string => (bytes < 1e5 ? `${(bytes / 1e3).toFixed(1)} KB` : `${Math.round(bytes / 1e3)} KB`);

/** The table of [CAR2 §II.A] in the colours of the index view: lights down, views across. */
function drawIndex({ description }: SateenMaterial): void {
  const canvas = get<HTMLCanvasElement>('index');
  const { views, lights, index, subspaces } = description;
  [canvas.width, canvas.height] = [views.length, lights.length];
  const image = new ImageData(views.length, lights.length);
  const colours = subspaceColours(subspaces.length).map((c) => c.getHex());
  index.forEach((k, i) => {
    const hex = k < 0 ? 0 : colours[k]!;
    image.data.set([hex >> 16, (hex >> 8) & 255, hex & 255, k < 0 ? 0 : 255], 4 * i);
  });
  canvas.getContext('2d')!.putImageData(image, 0, 0);
  get('index-text').textContent =
    `${lights.length} lights down, ${views.length} views across; ${subspaces.length} subspaces.`;
}

// ---------------------------------------------------------------- controls

const number = (id: string): number => Number(get<HTMLInputElement>(id).value);

function applyLook(): void {
  // A larger pattern has fewer texels on the same length.
  stage.setScale(USUAL_SCALE * 2 ** -number('scale'));
  for (const { material } of [shown.main, shown.other].filter((s) => s !== undefined)) {
    material.exposure = 2 ** number('exposure');
    material.relief = number('relief');
    material.tint.copy(new Color(get<HTMLInputElement>('tint').value));
  }
  const mode = document.querySelector<HTMLInputElement>('input[name="mode"]:checked')!.value;
  stage.setViewMode(mode as ViewMode);
}

for (const id of ['scale', 'relief', 'exposure', 'tint', 'modes']) get(id).addEventListener('input', applyLook);

get('shapes').addEventListener('change', (event) => {
  stage.setShape((event.target as HTMLInputElement).value as ShapeName);
});

const surroundings = get<HTMLSelectElement>('surroundings');
for (const [key, { label }] of Object.entries(SURROUNDINGS)) surroundings.add(new Option(label, key));
surroundings.addEventListener('change', () => stage.setSurroundings(surroundings.value));

const START_LAMP: LampDirection = { theta: 0.85, phi: 2.2 };
const lamp = bindLampPad(get('pad'), START_LAMP, (direction) => stage.setLamp(direction));
bindPointer(stage, lamp, () => get('keys').classList.add('seen'));

function pick(button: string, input: string, use: (file: File) => void): void {
  const chooser = get<HTMLInputElement>(input);
  get(button).addEventListener('click', () => chooser.click());
  chooser.addEventListener('change', () => {
    if (chooser.files?.[0]) use(chooser.files[0]);
    chooser.value = '';
  });
}
const openMesh = (file: File): void => {
  void import('./own_mesh')
    .then(({ readMesh }) => readMesh(file))
    .then((object) => {
      for (const radio of document.querySelectorAll<HTMLInputElement>('input[name="shape"]')) radio.checked = false;
      stage.setObject(object);
    })
    .catch((error: unknown) => say(`${file.name}: ${error instanceof Error ? error.message : String(error)}`));
};
const openFile = (file: File, compare = false): void => {
  if (/\.(glb|gltf|obj)$/i.test(file.name)) openMesh(file);
  else void open(file, file.name, compare);
};
pick('open', 'file', (file) => openFile(file));
pick('welcome-open', 'file', () => {});
pick('mesh', 'file-mesh', openMesh);
get('file-compare').addEventListener('change', (event) => {
  const chooser = event.target as HTMLInputElement;
  if (chooser.files?.[0]) openFile(chooser.files[0], true);
  chooser.value = '';
});
get('compare').addEventListener('click', () => {
  if (!stage.split) {
    get('file-compare').click();
    return;
  }
  shown.other?.material.dispose();
  delete shown.other;
  applyShown();
});

get('save').addEventListener('click', () => void savePicture());
async function savePicture(): Promise<void> {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await stage.screenshot());
  link.download = `${shown.main?.name ?? 'sateen'}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

get('reset').addEventListener('click', () => {
  for (const [id, value] of [['scale', '0'], ['relief', '1'], ['exposure', '0'], ['tint', '#ffffff']] as const)
    get<HTMLInputElement>(id).value = value;
  lamp.set(START_LAMP);
  stage.resetView();
  applyLook();
});

const toggle = get('toggle');
toggle.addEventListener('click', () => {
  const isOpen = get('panel').classList.toggle('open');
  toggle.setAttribute('aria-expanded', String(isOpen));
  toggle.textContent = isOpen ? 'Close' : 'Controls';
});

// ---------------------------------------------------------------- dropping

addEventListener('dragover', (event) => {
  event.preventDefault();
  document.body.classList.add('dropping');
});
addEventListener('dragleave', (event) => {
  if (!event.relatedTarget) document.body.classList.remove('dropping');
});
addEventListener('drop', (event) => {
  event.preventDefault();
  document.body.classList.remove('dropping');
  const files = [...(event.dataTransfer?.files ?? [])];
  // Two materials dropped together are compared.
  void (async () => {
    for (const [i, file] of files.slice(0, 2).entries())
      if (/\.(glb|gltf|obj)$/i.test(file.name)) openMesh(file);
      else await open(file, file.name, i === 1);
  })();
});

// ---------------------------------------------------------------- the divider of two materials

const divider = get('divider');
function placeDivider(): void {
  if (!stage.split) return;
  const percent = Math.round(100 * stage.split.at);
  divider.style.left = `${100 * stage.split.at}%`;
  divider.setAttribute('aria-valuenow', String(percent));
  stage.draw();
}
function moveDivider(at: number): void {
  if (!stage.split) return;
  stage.split.at = Math.min(0.98, Math.max(0.02, at));
  placeDivider();
}
divider.addEventListener('pointerdown', (event) => divider.setPointerCapture(event.pointerId));
divider.addEventListener('pointermove', (event) => {
  if (!divider.hasPointerCapture(event.pointerId)) return;
  const box = stage.canvas.getBoundingClientRect();
  moveDivider((event.clientX - box.left) / box.width);
});
divider.addEventListener('keydown', (event) => {
  const by = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
  if (by !== undefined) moveDivider((stage.split?.at ?? 0.5) + by);
});

// ---------------------------------------------------------------- light and dark

function setTheme(dark: boolean): void {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  get('theme').textContent = dark ? 'Light' : 'Dark';
  const style = getComputedStyle(document.documentElement);
  stage.setBackground(style.getPropertyValue('--top').trim(), style.getPropertyValue('--bottom').trim());
}
get('theme').addEventListener('click', () => setTheme(document.documentElement.dataset.theme !== 'dark'));
setTheme(matchMedia('(prefers-color-scheme: dark)').matches);

// ---------------------------------------------------------------- the first material

async function start(): Promise<void> {
  const embedded = document.getElementById('sateen-material');
  const url = QUERY.get('url');
  if (embedded) {
    const bytes = Uint8Array.from(atob(embedded.textContent!.trim()), (c) => c.charCodeAt(0));
    await open(bytes, embedded.dataset.name ?? 'material');
  } else if (url) await open(url, url.split('/').pop() ?? url);
  if (REFERENCE && shown.main) {
    showReference(REFERENCE);
    addEventListener('reference', (event) => showReference((event as CustomEvent<string>).detail));
  }
  get('welcome').hidden = shown.main !== undefined;
  document.body.dataset.started = 'true';
}
void start();
