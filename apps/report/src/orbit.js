// A camera that goes around a point: by mouse, fingers, wheel or keys.
import { PerspectiveCamera, Vector3 } from 'three';

const kStep = 0.08;
export const kFarthest = 60;  // m from what it looks at

export class Orbit {
  constructor(canvas, room, changed) {
    this.camera = new PerspectiveCamera(50, 1, 0.05, 140 + kFarthest);
    this.camera.up.set(0, 0, 1);
    this.room = room;
    this.changed = changed;
    this.look('behind');
    canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', (event) => this.drag(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    for (const kind of ['touchstart', 'touchmove']) {
      canvas.addEventListener(kind, (event) => this.fingers(event), { passive: false });
    }
  }

  /** Where one begins: behind the player, beside the lane, above it or at the skittles. */
  look(view) {
    const { ahead, behind, width, height, head_pin: pin } = this.room;
    const side = 0.5 * width - 0.3;
    const back = -Math.min(2.6, behind - 0.3);
    const places = {  // [camera, what it looks at]
      behind: [[-Math.min(1.5, side), back, Math.min(2.3, height - 0.3)], [0.15, 0.35 * pin, 0.5]],
      beside: [[Math.max(side, 0.9 * pin), 0.45 * pin, 1.6], [0, 0.45 * pin, 0.5]],
      above: [[0.01, 0.5 * (ahead - behind), 0.6 * (ahead + behind) + height], [0, 0.5 * (ahead - behind), 0]],
      skittles: [[-Math.min(1.1, side), pin - 1.6, 1.1], [0, pin + 0.3, 0.2]],
    };
    const [from, to] = places[view].map((p) => new Vector3(...p));
    const d = from.sub(to);
    this.target = to;
    this.away = d.length();
    this.turn = Math.atan2(d.y, d.x);
    this.rise = Math.asin(d.z / this.away);
    this.moved();
  }

  moved() {
    this.rise = Math.max(-1.569, Math.min(1.569, this.rise));
    this.away = Math.max(0.3, Math.min(kFarthest, this.away));
    const { turn, rise, away, target } = this;
    this.camera.position.set(target.x + away * Math.cos(rise) * Math.cos(turn),
      target.y + away * Math.cos(rise) * Math.sin(turn), target.z + away * Math.sin(rise));
    this.camera.lookAt(target);
    this.changed();
  }

  drag(event) {
    if (!event.buttons || event.pointerType === 'touch') return;
    if (event.shiftKey || event.buttons & 6) {
      this.slide(-event.movementX * 0.002, event.movementY * 0.002);
    } else {
      this.turn -= event.movementX * 0.006;
      this.rise += event.movementY * 0.006;
    }
    this.moved();
  }

  slide(right, up) {
    const m = this.camera.matrix.elements;
    this.target.addScaledVector(new Vector3(m[0], m[1], m[2]), right * this.away);
    this.target.addScaledVector(new Vector3(m[4], m[5], m[6]), up * this.away);
  }

  /** Two fingers turn the camera, and pinch; one scrolls the page. */
  fingers(event) {
    if (event.touches.length !== 2) return;
    event.preventDefault();
    const [a, b] = event.touches;
    const now = { x: 0.5 * (a.clientX + b.clientX), y: 0.5 * (a.clientY + b.clientY),
      apart: Math.max(1, Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY)) };
    if (event.type === 'touchmove' && this.touched) {
      this.turn -= (now.x - this.touched.x) * 0.006;
      this.rise += (now.y - this.touched.y) * 0.006;
      this.away *= this.touched.apart / now.apart;
      this.moved();
    }
    this.touched = now;
  }

  /** Comes nearer where the picture was clicked, or with Ctrl; else the page scrolls. */
  wheel(event) {
    if (!event.ctrlKey && document.activeElement !== event.currentTarget) return;
    event.preventDefault();
    this.away *= Math.exp(event.deltaY * 0.001);
    this.moved();
  }

  /** @return  whether the key was one of its own */
  key(key) {
    const moves = {
      a: () => { this.turn -= kStep; },
      d: () => { this.turn += kStep; },
      w: () => { this.rise += kStep; },
      s: () => { this.rise -= kStep; },
      r: () => { this.away /= 1.1; },
      f: () => { this.away *= 1.1; },
    };
    if (!moves[key]) return false;
    moves[key]();
    this.moved();
    return true;
  }
}
