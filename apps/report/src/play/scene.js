// The room and what moves in it, drawn through the eyes of the player.
import { Color, ColorManagement, Group, LinearSRGBColorSpace, PerspectiveCamera, Quaternion,
  Vector3, WebGLRenderer } from 'three';

import { lookAtWebGl } from '../webgl.js';
import { Board, Looks, makeRoom, place, reachOf, Rings, Shade } from '../world.js';

ColorManagement.enabled = false;  // as in view.js

const kCoarse = 0.4;  // pixels of the picture a pixel of the screen, in software
const kPose = 7;
// Where the view has what, as scene/page/page_session.h says.
const kView = { ellipsoids: 0, closed: 1, handSeen: 2, headSeen: 3, held: 4, X_WP: 5, X_WH: 12, X_WD: 19, bodies: 26 };

export const poseAt = (view, at) => view.subarray(at, at + kPose);
export const inView = kView;

/** Of a matrix: w, x, y, z of the turn, then the place. */
export function poseOf(matrix) {
  const [p, q, s] = [new Vector3(), new Quaternion(), new Vector3()];
  matrix.decompose(p, q, s);
  return [q.w, q.x, q.y, q.z, p.x, p.y, p.z];
}

/** What is drawn of the view: the same as a trial for Looks and Cast. */
export class Room {
  /**
   * @param page  {json, numbers, sections}: the page's scenario
   * @throws  in words where the browser cannot draw
   */
  constructor(canvas, page) {
    const { software, why } = lookAtWebGl();
    if (why) throw new Error(`this browser cannot draw in 3D (${why}); it needs WebGL 2`);
    this.canvas = canvas;
    this.json = page.json;
    this.renderer = new WebGLRenderer({ canvas, antialias: !software });
    // Without a graphics card every pixel costs.
    this.pixels = software ? kCoarse : Math.min(devicePixelRatio, 2);
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.looks = new Looks(page);
    this.scene = makeRoom(page, this.looks);
    this.scene.background = new Color(...page.json.light.background).convertLinearToSRGB();
    this.camera = new PerspectiveCamera(60, 1, 0.05, reachOf(this.scene, 60));
    this.rig = new Group();  // the tracked space T, in the world
    this.rig.add(this.camera);
    this.scene.add(this.rig);
    this.shade = new Shade(this.looks.light);
    this.board = new Board(page, this.looks);
    this.scene.add(this.board.group);
    const moving = page.json.actors.filter(({ role }) => role === 'skittle' || role === 'ball');
    this.bodies = moving.map((actor) => this.actor(actor));
    this.hand = this.actor(page.json.actors.find(({ role }) => role === 'hand'));
    this.balls = this.bodies.filter(({ role }) => role === 'ball');
    this.rings = new Rings(page, this.looks);
    this.balls[0]?.objects[0].add(this.rings.group);
    this.software = software === true;
    this.rough = false;
    this.thin(this.software);
  }

  actor({ role, meshes }) {
    const objects = meshes.map((number) => this.looks.mesh(number));
    for (const object of objects) {
      object.visible = false;
      this.scene.add(object);
    }
    return { role, objects, meshes };
  }

  /** A left hand is the mirror image of a right one, and so are the holes of its ball; meshes of files stay as they are. */
  playWith(leftHand) {
    const { mirrors_hand: hand, mirrors_ball: ball } = this.json.left_handed;
    const side = (mirrored) => (leftHand && mirrored ? -1 : 1);
    for (const object of this.hand.objects) object.scale.x = side(hand);
    for (const { objects } of this.balls) for (const object of objects) object.scale.x = side(ball);
    this.rings.group.scale.x = side(ball);  // they are on a ball, and are not mirrored
  }

  show({ objects }, which, pose) {
    objects.forEach((object, i) => { object.visible = i === which; });
    place(objects[which], pose);
  }

  /** Puts rings of oil on a ball, as the news have them. */
  putRings({ ball, each }) {
    this.rings.put(each);
    this.balls[ball]?.objects[0].add(this.rings.group);
  }

  /** Draws fewer triangles, or all of them again. */
  thin(rough) {
    if (rough === this.rough) return;
    this.rough = rough;
    for (const { objects, meshes } of [...this.bodies, this.hand]) {
      objects.forEach((object, i) => { object.geometry = this.looks.geometry(meshes[i], rough); });
    }
  }

  /** Puts everything where the view has it. */
  put(view) {
    this.shade.clear();
    this.bodies.forEach((body, i) => {
      const pose = poseAt(view, kView.bodies + kPose * i);
      const ellipsoid = body.role === 'skittle' && view[kView.ellipsoids] > 0;
      this.show(body, ellipsoid ? 1 : 0, pose);
      this.shade.add(body.role, pose);
    });
    if (view[kView.handSeen] > 0) {
      const hands = this.hand.objects.length;
      this.show(this.hand, Math.round(view[kView.closed] * (hands - 1)), poseAt(view, kView.X_WH));
    } else {
      for (const object of this.hand.objects) object.visible = false;
    }
  }

  /**
   * Puts the tracked space where the player has walked to.
   * @param X_TF  a space in it, in which the camera is instead
   */
  putRig(view, X_WT, X_TF = null) {
    const { rig } = this;
    place(rig, X_WT);
    rig.position.x += view[kView.X_WP + 4];
    rig.position.y += view[kView.X_WP + 5];
    if (!X_TF) return;
    rig.updateMatrix();
    rig.matrix.multiply(X_TF).decompose(rig.position, rig.quaternion, rig.scale);
  }

  /** Draws on the canvas, from a head in the tracked space. */
  draw(X_TD) {
    const { canvas, camera, renderer } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    const { pixels } = this;
    if (canvas.width !== Math.floor(width * pixels) || canvas.height !== Math.floor(height * pixels)) {
      renderer.setPixelRatio(pixels);
      renderer.setSize(width, height, false);
    }
    camera.aspect = width / height;
    // As much is seen across an upright phone as the lane needs.
    camera.fov = camera.aspect > 0.9 ? 60 : 82;
    camera.updateProjectionMatrix();
    place(camera, X_TD);
    renderer.render(this.scene, camera);
  }
}
