// The room and what moves in it, as three.js draws them.
import { Box3, BufferAttribute, BufferGeometry, Group, Mesh, Scene, Sphere } from 'three';

import { coded, makeLight, materialOf } from './materials.js';

const kCell = 0.025;  // m

function geometryOf(trial, { number, surface }) {
  const rowsOf = (name) => trial.sections.get(name);
  const vertices = rowsOf(`mesh ${number} vertices`);
  const triangles = rowsOf(`mesh ${number} triangles`);
  const part = (from) => {
    const values = new Float32Array(vertices.rows * 3);
    for (let row = 0; row < vertices.rows; ++row) {
      const at = vertices.offset + row * 9 + from;
      values.set(trial.numbers.subarray(at, at + 3), row * 3);
    }
    return new BufferAttribute(values, 3);
  };
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', part(0));
  geometry.setAttribute('normal', part(3));
  const colour = part(6);
  if (surface !== 'lit') colour.array.forEach((value, i) => { colour.array[i] = coded(value); });
  geometry.setAttribute('colour', colour);
  const indices = trial.numbers.subarray(triangles.offset, triangles.offset + 3 * triangles.rows);
  geometry.setIndex(new BufferAttribute(Uint32Array.from(indices), 1));
  return geometry;
}

/** The same in fewer triangles: the vertices of a cell become one of them. */
function thinned(geometry) {
  const { position, normal, colour } = geometry.attributes;
  const firstIn = new Map();
  const kept = Array.from({ length: position.count }, (_, i) => {
    const cell = [position.getX(i), position.getY(i), position.getZ(i)].map((x) => Math.round(x / kCell)).join();
    if (!firstIn.has(cell)) firstIn.set(cell, i);
    return firstIn.get(cell);
  });
  const old = geometry.index.array;
  const index = [];
  for (let i = 0; i < old.length; i += 3) {
    const [a, b, c] = [kept[old[i]], kept[old[i + 1]], kept[old[i + 2]]];
    if (a !== b && b !== c && c !== a) index.push(a, b, c);
  }
  const thin = new BufferGeometry();
  for (const [name, values] of Object.entries({ position, normal, colour })) thin.setAttribute(name, values);
  thin.setIndex(index);
  return thin;
}

export function place(object, pose) {
  object.quaternion.set(pose[1], pose[2], pose[3], pose[0]);
  object.position.set(pose[4], pose[5], pose[6]);
}

/** Meshes by number, and the light that they stand in; several casts of a play share them. */
export class Looks {
  constructor(trial) {
    this.light = makeLight(trial.json.light);
    this.meshes = new Map(trial.json.meshes.map((mesh) => [mesh.number, mesh]));
    this.geometries = new Map();
    this.thin = new Map();
    for (const mesh of trial.json.meshes) this.geometries.set(mesh.number, geometryOf(trial, mesh));
  }

  /** The shape of a mesh, or a rough one where a picture is coarse. */
  geometry(number, thin) {
    if (!thin) return this.geometries.get(number);
    if (!this.thin.has(number)) this.thin.set(number, thinned(this.geometries.get(number)));
    return this.thin.get(number);
  }

  /** Gives back what three.js keeps of all shapes. */
  release() {
    for (const geometry of [...this.geometries.values(), ...this.thin.values()]) geometry.dispose();
  }

  mesh(number, style) {
    return new Mesh(this.geometry(number, false), materialOf(this.meshes.get(number), this.light, style));
  }
}

/** The rings of oil that the last throw left on its ball: none where a room has none. */
export class Rings {
  constructor({ json: { rings } }, looks, style = {}) {
    this.number = looks.meshes.has(rings?.mesh) ? rings.mesh : -1;
    this.looks = looks;
    this.style = style;
    this.group = new Group();
    this.each = [];
  }

  /** @param each  of each ring its pose on the ball, and its radius */
  put(each) {
    if (this.number < 0 || each === this.each) return;
    this.each = each;
    const { children } = this.group;
    while (children.length < each.length) this.group.add(this.looks.mesh(this.number, this.style));
    children.forEach((ring, i) => {
      ring.visible = i < each.length;
      if (!ring.visible) return;
      place(ring, each[i]);
      ring.scale.set(each[i][7], each[i][7], 1);
    });
  }
}

/** What moves of one trial: skittles, balls, hand and head. */
export class Cast {
  constructor(trial, looks, style = {}) {
    this.trial = trial;
    this.looks = looks;
    this.style = style;
    this.group = new Group();
    this.shown = trial.json.actors.map(() => ({ mesh: -1, objects: new Map() }));
    this.pose = new Float32Array(7);
    this.rings = new Rings(trial, looks, style);
    this.group.add(this.rings.group);
  }

  /** Draws rough shapes, or again whole ones. */
  thin(thin) {
    for (const { objects } of this.shown) {
      for (const [number, object] of objects) object.geometry = this.looks.geometry(number, thin);
    }
  }

  /** @param without  roles that are not seen, as the head by its own eyes */
  put(tick, without = []) {
    const meshes = this.trial.meshesAt(tick);
    this.shown.forEach((shown, actor) => {
      if (meshes[actor] !== shown.mesh) this.change(shown, meshes[actor]);
      const object = shown.objects.get(shown.mesh);
      if (!object) return;
      object.visible = !without.includes(this.trial.json.actors[actor].role);
      place(object, this.trial.pose(actor, tick, this.pose));
    });
    const { ball, each } = this.trial.ringsAt(tick);
    this.rings.put(each);
    if (ball >= 0) place(this.rings.group, this.trial.pose(ball, tick, this.pose));
  }

  change(shown, mesh) {
    const old = shown.objects.get(shown.mesh);
    if (old) old.visible = false;
    shown.mesh = mesh;
    if (mesh < 0 || !this.looks.meshes.has(mesh)) return;
    if (!shown.objects.has(mesh)) {
      const object = this.looks.mesh(mesh, this.style);
      shown.objects.set(mesh, object);
      this.group.add(object);
    }
    shown.objects.get(mesh).visible = true;
  }

  /** Balls and skittles keep light from the floor. */
  castShade(tick) {
    const shade = new Shade(this.looks.light);
    for (const role of ['ball', 'skittle']) {
      for (const actor of this.trial.actors(role)) shade.add(role, this.trial.pose(actor, tick, this.pose));
    }
  }
}

/** The light that balls and skittles keep from the floor: one ball each will do from here. */
export class Shade {
  static reach = 0.6;  // m, beyond which it is too faint to see
  static of = { ball: { radius: 0.1, lower: 0 }, skittle: { radius: 0.055, lower: 0.1 } };  // m

  constructor({ occluders, shaded }) {
    this.occluders = occluders.value;
    this.shaded = shaded.value;
    this.clear();
  }

  clear() {
    this.shaded.set(Infinity, Infinity, -Infinity, -Infinity);
    this.used = 0;
  }

  add(role, p) {
    const { occluders, shaded } = this;
    if (this.used === occluders.length) return;
    const { radius, lower } = Shade.of[role];
    // A skittle's lower part shades: its axis is the third of its turn.
    const [w, x, y, z] = p;
    const one = occluders[this.used++].set(
      p[4] - lower * 2 * (x * z + w * y), p[5] - lower * 2 * (y * z - w * x),
      p[6] - lower * (1 - 2 * (x * x + y * y)), radius);
    shaded.set(Math.min(shaded.x, one.x - Shade.reach), Math.min(shaded.y, one.y - Shade.reach),
      Math.max(shaded.z, one.x + Shade.reach), Math.max(shaded.w, one.y + Shade.reach));
  }
}

/** The characters of the score board: none where a room has no board. */
export class Board {
  constructor({ json: { board } }, looks) {
    this.looks = looks;
    this.group = new Group();
    this.characters = board?.characters ?? {};
    this.cells = (board?.cells ?? []).map((row) => row.map((p) => this.cell(p)));
  }

  cell(p) {
    const object = this.looks.mesh(this.characters['0']);
    object.visible = false;
    object.position.set(...p);
    this.group.add(object);
    return object;
  }

  /** @param text  its rows */
  put(text) {
    this.cells.forEach((row, i) => row.forEach((object, j) => {
      const number = this.characters[text[i]?.[j]];
      object.visible = number !== undefined;
      if (object.visible) object.geometry = this.looks.geometry(number, false);
    }));
  }
}

export function makeRoom(trial, looks) {
  const scene = new Scene();
  for (const { mesh, X_WG } of trial.json.still) {
    const object = looks.mesh(mesh);
    place(object, X_WG);
    scene.add(object);
  }
  return scene;
}

/** How far a camera in a room sees [m]: to the other end of the room, and `least` at least. */
export function reachOf(room, least) {
  const { radius } = new Box3().setFromObject(room).getBoundingSphere(new Sphere());
  return Math.max(least, 2 * radius);
}
