// The picture: the room from anywhere, or through the eyes with the display's own pixels.
import { Mesh, NearestFilter, OrthographicCamera, PerspectiveCamera, PlaneGeometry, Scene,
         ShaderMaterial, WebGLRenderer, WebGLRenderTarget, Color, ColorManagement, LinearSRGBColorSpace,
         Quaternion, Vector3 } from 'three';

import { kFarthest, Orbit } from './orbit.js';
import { Contacts, Frusta, Trails } from './overlays.js';
import { lookAtWebGl } from './webgl.js';
import { Board, Cast, Looks, makeRoom, reachOf } from './world.js';

// Colours are coded by our own shaders or given coded: three.js has nothing to convert.
ColorManagement.enabled = false;

const kSettled = 200;  // ms after the last change
const kCoarse = 0.4;   // pixels of the picture a pixel of the screen, while it changes, in software
const kOtherTint = [0.55, 0.8, 1.25];

/** What stands in for the picture where the browser has no WebGL: all else of the page works. */
class NoView {
  constructor(canvas, trial, why) {
    this.why = why;
    this.mode = 'around';
    this.layers = {};
    this.orbit = { look() {}, key() {} };
    canvas.hidden = true;
    this.load(trial);
  }

  load(trial) {
    this.trial = trial;
  }

  setMode(mode) {
    this.mode = mode;
  }

  addOverlays() {}
  draw() {}
  drawNow() {}
  show() {}
}

/** The picture, or what stands in for it. */
export function openView(canvas, trial, other) {
  const { software, why } = lookAtWebGl();
  if (why) return new NoView(canvas, trial, why);
  // Without a graphics card every pixel costs: smooth edges and fine pixels are left out then.
  return new View(canvas, trial, other, software);
}

/** Gives back what three.js keeps of materials. Geometries belong to the looks. */
function releaseMaterials(object) {
  object.traverse((part) => part.material?.dispose());
}

function releaseOverlay({ group }) {
  releaseMaterials(group);
  group.traverse((part) => part.geometry?.dispose());
}

/** The pictures of one eye: drawn in the display's pixels, shown as wide as they are seen. */
class Eye {
  constructor(eye) {
    this.eye = eye;
    const { left, right, bottom, top, near, far } = eye.frustum;
    this.camera = new PerspectiveCamera();
    this.camera.matrixAutoUpdate = false;
    this.camera.projectionMatrix.makePerspective(left * near, right * near, top * near,
      bottom * near, near, Math.max(far, 60));
    this.camera.projectionMatrixInverse.copy(this.camera.projectionMatrix).invert();
    this.aspect = (right - left) / (top - bottom);
    const target = (samples) => new WebGLRenderTarget(eye.width, eye.height,
      { samples, minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false });
    this.target = { fine: target(4), coarse: target(0) };
    const [w, x, y, z, ...p] = eye.X_DE;
    this.q_DE = new Quaternion(x, y, z, w);
    this.p_DE = new Vector3(...p);
  }

  release() {
    for (const target of Object.values(this.target)) target.dispose();
  }

  put(head) {
    const q = new Quaternion(head[1], head[2], head[3], head[0]);
    const p = this.p_DE.clone().applyQuaternion(q).add(new Vector3(head[4], head[5], head[6]));
    this.camera.matrix.compose(p, q.multiply(this.q_DE), new Vector3(1, 1, 1));
    this.camera.matrixWorldNeedsUpdate = true;
  }
}

class View {
  constructor(canvas, trial, other, software) {
    this.canvas = canvas;
    this.software = software;
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.software });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.mode = 'around';
    this.layers = { trails: true, frusta: true, contacts: true, other: true };
    this.wanted = false;
    this.tick = 0;
    this.orbit = new Orbit(canvas, trial.json.room, () => this.draw());
    this.allLooks = new Map();  // of each trial that has meshes
    this.quad = new Mesh(new PlaneGeometry(2, 2), new ShaderMaterial({
      uniforms: { picture: { value: null } },
      vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: 'uniform sampler2D picture; varying vec2 at; void main() { gl_FragColor = texture2D(picture, at); }',
      depthTest: false,
    }));
    this.screen = new Scene();
    this.screen.add(this.quad);
    this.flat = new OrthographicCamera(-1, 1, 1, -1, 0, 1);
    this.stage(trial, other);
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Shows another trial, or the same one simulated again. */
  load(trial, other) {
    const { scene, overlays, eyes } = this;
    for (const overlay of Object.values(overlays)) {
      scene.remove(overlay.group);
      releaseOverlay(overlay);
    }
    this.setOther(null);
    this.stage(trial, other);
    releaseMaterials(scene);
    this.releaseLooks();
    for (const eye of eyes) eye.release();
    this.addOverlays();
  }

  /** What a trial looks like: one without meshes looks like another one, `looksLike`. */
  looksOf(trial) {
    const own = trial.looksLike ?? trial;
    if (!this.allLooks.has(own)) this.allLooks.set(own, new Looks(own));
    return this.allLooks.get(own);
  }

  /** Gives back the looks of trials that are not shown. */
  releaseLooks() {
    const shown = [this.looks, this.otherCast?.looks];
    for (const [trial, looks] of this.allLooks) {
      if (shown.includes(looks)) continue;
      looks.release();
      this.allLooks.delete(trial);
    }
  }

  /** The room and those in it: all of a first picture. */
  stage(trial, other) {
    this.trial = trial;
    this.head = trial.actors('head')[0];
    this.looks = this.looksOf(trial);
    this.orbit.room = trial.json.room;
    this.scene = makeRoom(trial, this.looks);
    this.orbit.camera.far = kFarthest + reachOf(this.scene, 140);
    this.scene.background = null;
    this.cast = new Cast(trial, this.looks);
    this.board = new Board(trial, this.looks);
    this.scene.add(this.board.group);
    this.eyes = trial.json.eyes.map((eye) => new Eye(eye));
    this.background = new Color(...trial.json.light.background).convertLinearToSRGB();
    this.overlays = {};
    this.scene.add(this.cast.group);
    this.setOther(other);
    this.pose = new Float32Array(7);
  }

  addOverlays() {
    const { trial } = this;
    this.overlays = { trails: new Trails(trial), frusta: new Frusta(trial), contacts: new Contacts(trial) };
    for (const overlay of Object.values(this.overlays)) this.scene.add(overlay.group);
    this.draw();
  }

  /** A second trial over the first, see-through and blue. */
  setOther(other) {
    if (this.otherCast) {
      this.scene.remove(this.otherCast.group);
      releaseMaterials(this.otherCast.group);
    }
    this.otherCast = null;
    this.other = other;
    if (other) {
      this.otherCast = new Cast(other, this.looksOf(other), { opacity: 0.55, tint: kOtherTint });
      this.scene.add(this.otherCast.group);
    }
    this.draw();
  }

  setMode(mode) {
    this.mode = mode;
    this.draw();
  }

  show(tick) {
    this.tick = tick;
    this.draw();
  }

  /** Once before the next picture of the screen, however often it is asked. */
  draw() {
    if (!this.cast || this.wanted) return;
    this.wanted = true;
    clearTimeout(this.settling);
    requestAnimationFrame(() => {
      this.wanted = false;
      this.drawNow(true);
      if (this.software) this.settling = setTimeout(() => this.drawNow(), kSettled);
    });
  }

  /** @param quick  while it changes: without a graphics card in few pixels and triangles */
  drawNow(quick = false) {
    this.coarse = quick && this.software;
    const pixels = this.coarse ? kCoarse : this.software ? 1 : Math.min(devicePixelRatio, 2);
    const { canvas, renderer } = this;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!width || !height) return;
    if (canvas.width !== Math.floor(width * pixels) || canvas.height !== Math.floor(height * pixels)) {
      renderer.setPixelRatio(pixels);
      renderer.setSize(width, height, false);
    }
    this.cast.thin(this.coarse);
    this.cast.put(this.tick);
    if (this.trial.json.board) this.board.put(this.trial.boardAt(this.tick));
    this.cast.castShade(this.tick);
    if (this.otherCast) {
      this.otherCast.thin(this.coarse);
      this.otherCast.put(Math.min(this.tick, this.other.lastTick));
      this.otherCast.group.visible = this.layers.other;
    }
    renderer.setRenderTarget(null);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
    if (this.mode === 'around') this.drawAround(width, height);
    else this.drawEyes(width, height);
    this.drawn = (this.drawn ?? 0) + 1;
  }

  clear(black) {
    this.renderer.setClearColor(black ? 0x000000 : this.background, 1);
    this.renderer.clear();
  }

  drawAround(width, height) {
    for (const [name, overlay] of Object.entries(this.overlays)) {
      overlay.group.visible = this.layers[name];
      if (this.layers[name]) overlay.put(this.tick);
    }
    this.orbit.camera.aspect = width / height;
    this.orbit.camera.updateProjectionMatrix();
    this.clear();
    this.renderer.render(this.scene, this.orbit.camera);
  }

  /** Where each wanted eye's picture stands on the canvas: [eye, x, y, width, height], CSS pixels. */
  eyeFrames(width, height) {
    const wanted = { left: [0], right: [1], both: [0, 1] }[this.mode];
    const each = width / wanted.length;
    return wanted.map((eye, i) => {
      const w = Math.min(each - (wanted.length > 1 ? 4 : 0), height * this.eyes[eye].aspect);
      const h = w / this.eyes[eye].aspect;
      return [eye, i * each + (each - w) / 2, (height - h) / 2, w, h];
    });
  }

  drawEyes(width, height) {
    for (const [name, overlay] of Object.entries(this.overlays)) {
      overlay.group.visible = name === 'contacts' && this.layers.contacts;
    }
    if (this.layers.contacts) this.overlays.contacts?.put(this.tick);
    if (this.head !== undefined) this.trial.pose(this.head, this.tick, this.pose);
    this.cast.put(this.tick, ['head']);
    if (this.otherCast) this.otherCast.put(Math.min(this.tick, this.other.lastTick), ['head']);
    this.clear(true);
    for (const [number, x, y, w, h] of this.eyeFrames(width, height)) {
      const eye = this.eyes[number];
      eye.put(this.pose);
      const target = this.coarse ? eye.target.coarse : eye.target.fine;
      this.renderer.setRenderTarget(target);
      this.clear();
      this.renderer.render(this.scene, eye.camera);
      this.renderer.setRenderTarget(null);
      this.renderer.setViewport(x, y, w, h);
      this.quad.material.uniforms.picture.value = target.texture;
      this.renderer.render(this.screen, this.flat);
    }
  }
}
