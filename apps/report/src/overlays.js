// What is drawn over the room: trails, what the eyes look through, contacts with their impulses.
import { ArrowHelper, BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, LineSegments,
         Vector3 } from 'three';

import { place } from './world.js';

const kTrailColours = { head: 0xe69f00, hand: 0x009e73, ball: 0x0072b2 };  // Okabe and Ito
const kFrustumColours = [0x56b4e9, 0xd55e00];
const kContactSeconds = 0.05;
const kMostArrows = 64;
const kFrustumLength = 1.2;  // m
const kTrailStep = 0.02;         // m, from one point to the next
const kTrailSeconds = 4;         // that are drawn strong
const kWholeTrailSeconds = 30;   // longer trials would be hidden behind their own trails

/** Where an actor was, and at which rows: a point wherever it has moved on. */
function pointsOf(trial, actor) {
  const rows = [];
  const points = [];
  const pose = new Float32Array(7);
  for (let row = 0; row < trial.json.drawn.rows; ++row) {
    const [, , , , x, y, z] = trial.pose(actor, trial.tickOfRow(row), pose);
    const [x0, y0, z0] = points.slice(-3);
    if (rows.length && Math.hypot(x - x0, y - y0, z - z0) < kTrailStep) continue;
    rows.push(row);
    points.push(x, y, z);
  }
  return { rows, points };
}

/** How many of ascending rows are not after one. */
function countUpTo(rows, row) {
  let low = 0;
  let high = rows.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[middle] <= row) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Where head, hand and ball were: the last seconds strong, all of a short trial faint. */
export class Trails {
  constructor(trial) {
    this.group = new Group();
    this.lines = [];
    for (const role of Object.keys(kTrailColours)) {
      for (const actor of trial.actors(role)) {
        const { rows, points } = pointsOf(trial, actor);
        const geometry = new BufferGeometry();
        geometry.setAttribute('position', new BufferAttribute(Float32Array.from(points), 3));
        const line = (opacity) => {
          const one = new Line(geometry, new LineBasicMaterial({
            color: kTrailColours[role], transparent: opacity < 1, opacity }));
          one.frustumCulled = false;
          this.group.add(one);
          return one;
        };
        if (trial.seconds(trial.lastTick) <= kWholeTrailSeconds) line(0.25);
        const past = line(1);
        past.geometry = geometry.clone();
        this.lines.push({ line: past, rows });
      }
    }
    this.trial = trial;
  }

  put(tick) {
    const row = (at) => this.trial.rowsAt(Math.max(0, at)).row;
    const [first, last] = [row(tick - kTrailSeconds * this.trial.rate), row(tick)];
    for (const { line, rows } of this.lines) {
      const from = Math.max(0, countUpTo(rows, first) - 1);
      line.geometry.setDrawRange(from, countUpTo(rows, last) - from);
    }
  }
}

/** What each eye sees through, and where the head looks. */
export class Frusta {
  constructor(trial) {
    this.trial = trial;
    this.head = trial.actors('head')[0];
    this.group = new Group();
    this.pose = new Float32Array(7);
    trial.json.eyes.forEach((eye, i) => {
      const { left, right, bottom, top } = eye.frustum;
      const far = [[left, bottom], [right, bottom], [right, top], [left, top]].map(([x, y]) =>
        new Vector3(x * kFrustumLength, y * kFrustumLength, -kFrustumLength));
      const points = [];
      far.forEach((corner, k) => points.push(new Vector3(), corner, corner, far[(k + 1) % 4]));
      points.push(new Vector3(), new Vector3(0, 0, -2 * kFrustumLength));  // its axis
      const lines = new LineSegments(new BufferGeometry().setFromPoints(points),
        new LineBasicMaterial({ color: kFrustumColours[i] }));
      lines.frustumCulled = false;
      place(lines, eye.X_DE);
      this.group.add(lines);
    });
  }

  put(tick) {
    if (this.head === undefined) {
      this.group.visible = false;
      return;
    }
    place(this.group, this.trial.pose(this.head, tick, this.pose));
  }
}

/** The impulses of the last twentieth of a second, as long as the root of their size. */
export class Contacts {
  constructor(trial) {
    this.trial = trial;
    this.group = new Group();
    this.arrows = Array.from({ length: kMostArrows }, () => {
      const arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.1, 0xcc2222, 0.03, 0.02);
      arrow.visible = false;
      for (const part of [arrow.line, arrow.cone]) {
        part.material.depthTest = false;  // seen through what they act on
        part.renderOrder = 1;
      }
      this.group.add(arrow);
      return arrow;
    });
  }

  put(tick) {
    const now = Math.floor(tick);
    const rows = [...this.trial.contacts(now - kContactSeconds * this.trial.rate, now)];
    rows.sort((a, b) => Math.hypot(b[6], b[7], b[8]) - Math.hypot(a[6], a[7], a[8]));
    this.arrows.forEach((arrow, i) => {
      arrow.visible = i < rows.length;
      if (!arrow.visible) return;
      const [, , , x, y, z, jx, jy, jz] = rows[i];
      const size = Math.hypot(jx, jy, jz);
      const length = 0.06 + 0.2 * Math.sqrt(size);
      arrow.position.set(x, y, z);
      arrow.setDirection(new Vector3(jx, jy, jz).divideScalar(size));
      arrow.setLength(length, 0.3 * length, 0.15 * length);
    });
    return rows.length;
  }
}
