// The room and what moves in it, as three.js draws them.
import { BufferAttribute, BufferGeometry, Group, Mesh, Scene } from 'three';

import { makeLight, materialOf } from './materials.js';

function geometryOf(trial, number) {
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
  geometry.setAttribute('colour', part(6));
  const indices = trial.numbers.subarray(triangles.offset, triangles.offset + 3 * triangles.rows);
  geometry.setIndex(new BufferAttribute(Uint32Array.from(indices), 1));
  return geometry;
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
    for (const number of this.meshes.keys()) this.geometries.set(number, geometryOf(trial, number));
  }

  mesh(number, style) {
    return new Mesh(this.geometries.get(number), materialOf(this.meshes.get(number), this.light, style));
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

  /** Balls and skittles keep light from the floor: one ball each will do from here. */
  castShade(tick) {
    const { occluders: { value: occluders }, shaded: { value: shaded } } = this.looks.light;
    const reach = 0.6;  // m, beyond which it is too faint to see
    shaded.set(Infinity, Infinity, -Infinity, -Infinity);
    let used = 0;
    for (const [role, radius, lower] of [['ball', 0.1, 0], ['skittle', 0.055, 0.1]]) {
      for (const actor of this.trial.actors(role)) {
        if (used === occluders.length) return;
        const p = this.trial.pose(actor, tick, this.pose);
        // A skittle's lower part shades: its axis is the third of its turn.
        const [w, x, y, z] = p;
        const one = occluders[used++].set(
          p[4] - lower * 2 * (x * z + w * y), p[5] - lower * 2 * (y * z - w * x),
          p[6] - lower * (1 - 2 * (x * x + y * y)), radius);
        shaded.set(Math.min(shaded.x, one.x - reach), Math.min(shaded.y, one.y - reach),
          Math.max(shaded.z, one.x + reach), Math.max(shaded.w, one.y + reach));
      }
    }
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
