// SPDX-License-Identifier: Apache-2.0
// The lamp and the view by mouse, touch and keyboard.
import type { Stage } from './stage';

/** To the lamp: theta from the line of sight, phi counter-clockwise from the right. Radians. */
export interface LampDirection {
  theta: number;
  phi: number;
}

export interface Lamp {
  set(direction: LampDirection): void;
  /** Moves it as if it lay on a half ball facing the viewer, by parts of the ball's radius. */
  move(right: number, up: number): void;
}

const LARGEST_THETA = 1.5;

export function bindLampPad(pad: HTMLElement, first: LampDirection, use: (d: LampDirection) => void): Lamp {
  const dot = pad.firstElementChild as HTMLElement;
  let [x, y] = [0, 0];
  // The disc is an azimuthal map: the distance from its centre is theta.
  const put = (right: number, up: number): void => {
    const length = Math.hypot(right, up);
    const shrink = length > 1 ? 1 / length : 1;
    [x, y] = [right * shrink, up * shrink];
    const direction = { theta: Math.hypot(x, y) * LARGEST_THETA, phi: Math.atan2(y, x) };
    dot.style.left = `${50 + 50 * x}%`;
    dot.style.top = `${50 - 50 * y}%`;
    const degrees = (angle: number): number => Math.round((angle * 180) / Math.PI);
    pad.setAttribute('aria-valuenow', String(degrees(direction.theta)));
    pad.setAttribute('aria-valuetext',
      `${degrees(direction.theta)}° from the viewer, turned ${(degrees(direction.phi) + 360) % 360}°`);
    use(direction);
  };
  const lamp: Lamp = {
    set: ({ theta, phi }) => put((theta / LARGEST_THETA) * Math.cos(phi), (theta / LARGEST_THETA) * Math.sin(phi)),
    move: (right, up) => put(x + right, y + up),
  };
  const follow = (event: PointerEvent): void => {
    const box = pad.getBoundingClientRect();
    put((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
  };
  pad.addEventListener('pointerdown', (event) => {
    pad.setPointerCapture(event.pointerId);
    follow(event);
  });
  pad.addEventListener('pointermove', (event) => pad.hasPointerCapture(event.pointerId) && follow(event));
  pad.addEventListener('keydown', (event) => {
    const by = ARROWS[event.key];
    if (!by) return;
    event.preventDefault();
    lamp.move(0.08 * by[0], 0.08 * by[1]);
  });
  lamp.set(first);
  return lamp;
}

const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};

/** Right-drag and a drag of two fingers move the lamp; the rest is OrbitControls'. */
export function bindPointer(stage: Stage, lamp: Lamp, used: () => void): void {
  const { canvas } = stage;
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  const fingers = new Map<number, [number, number]>();
  canvas.addEventListener('pointerdown', (event) => {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    used();
  });
  canvas.addEventListener('pointermove', (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const movesLamp = event.pointerType === 'touch' ? fingers.size === 2 : (event.buttons & 2) !== 0 || event.altKey;
    stage.controls.enableRotate = !movesLamp;
    if (movesLamp) {
      const half = Math.min(canvas.clientWidth, canvas.clientHeight) / 2;
      const share = event.pointerType === 'touch' ? 0.5 : 1;
      lamp.move((share * (event.clientX - from[0])) / half, (-share * (event.clientY - from[1])) / half);
    }
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  for (const end of ['pointerup', 'pointercancel'] as const)
    canvas.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      if (fingers.size === 0) stage.controls.enableRotate = true;
    });
  canvas.addEventListener('wheel', used, { passive: true });
  canvas.addEventListener('keydown', (event) => {
    const by = ARROWS[event.key];
    if (by && event.shiftKey) lamp.move(0.08 * by[0], 0.08 * by[1]);
    else if (by) stage.turn(0.1 * by[0], 0.1 * by[1]);
    else if (event.key === '+' || event.key === '=') stage.zoom(0.9);
    else if (event.key === '-') stage.zoom(1 / 0.9);
    else return;
    event.preventDefault();
    used();
  });
}
