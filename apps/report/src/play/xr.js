// A headset of WebXR: its poses and buttons become samples of the session, and its own views are drawn.
import { Matrix4, Quaternion, Vector3 } from 'three';

import { poseOf } from './scene.js';

const kStations = { right: 2, left: 3 };
const kStick = 0.5;
const kRecentre = 4;          // the lower button (A, X) of a controller: WebXR Gamepads Module
const kPredicted = 25;        // ms that a pose is ahead in a browser that predicts, as in scene/page/browser_device.cpp
const kWatched = 90, kMostLate = 9;  // frames that are looked at, and how many of them may be late

/** What moment the poses of a frame are for. Some browsers do not say it, or say 0. */
const timeOf = (frame, otherwise) => frame?.predictedDisplayTime || otherwise;

const degrees = (tangent) => (180 / Math.PI) * Math.atan(tangent);

/** Whether a headset can be used here. */
export async function xrOffered() {
  try {
    return await navigator.xr.isSessionSupported('immersive-vr');
  } catch {
    return false;  // the browser has no WebXR, or this page may not use it
  }
}

/** Where a view is from the viewer [m], what it sees, from its projection: angles to each side [degrees], and its pixels. */
function described(view, viewer, { width, height }) {
  const m = view.projectionMatrix;
  const from = new Matrix4().fromArray(viewer.transform.inverse.matrix);
  const offset = poseOf(from.multiply(new Matrix4().fromArray(view.transform.matrix))).slice(4);
  return { eye: view.eye, offset, left: degrees((m[8] - 1) / m[0]), right: degrees((m[8] + 1) / m[0]),
    down: degrees((m[9] - 1) / m[5]), up: degrees((m[9] + 1) / m[5]), width, height };
}

export class XrPlay {
  constructor(room, json) {
    this.room = room;
    this.json = json;
    this.X_TF = null;           // the headset's floor space F in the tracked space T
    this.head = null;           // X_TD of the last frame
    this.pressed = new Set();  // names of events that hold the trigger: select, squeeze
    this.tracked = new Set();    // stations whose place the headset has tracked
    this.estimated = new Set();  // stations whose place the headset has only estimated
    this.late = [];
    this.keys = (event) => { if (event.key.toLowerCase() === 'r') this.asked = true; };
    this.leave = () => this.ended();
    this.onEnd = () => {};
    this.onTrouble = () => {};
  }

  /** Asks for the headset; to be called while the browser knows of a click. */
  async request() {
    this.session = await navigator.xr.requestSession('immersive-vr',
      { requiredFeatures: ['local-floor'], optionalFeatures: ['hand-tracking'] });
    this.session.addEventListener('end', this.leave);
  }

  /** Begins the headset's frames. @returns  the name of the device, once the first of them has come */
  async start() {
    const { renderer } = this.room;
    const { session } = this;
    this.floor = await session.requestReferenceSpace('local-floor');
    for (const [start, end, name] of [['selectstart', 'selectend', 'select'], ['squeezestart', 'squeezeend', 'squeeze']]) {
      session.addEventListener(start, (event) => this.trigger(event, name, true));
      session.addEventListener(end, (event) => this.trigger(event, name, false));
    }
    // The wearer has recentred the headset itself: its floor space has moved.
    this.floor.addEventListener('reset', () => { this.X_TF = null; });
    session.addEventListener('inputsourceschange', (event) => this.changed(event));
    session.addEventListener('visibilitychange', () => {  // as when the headset shows its menu
      if (this.game && session.visibilityState !== 'visible') this.letGo();
    });
    addEventListener('keydown', this.keys);  // of somebody who looks on
    renderer.xr.enabled = true;
    renderer.xr.setReferenceSpaceType('local-floor');
    await renderer.xr.setSession(session);
    session.removeEventListener('end', this.leave);
    session.addEventListener('end', this.leave);  // now after three.js, which gives the canvas its own size again
    return new Promise((resolve, reject) => {
      this.onEnd = () => reject(new Error('the headset was put away before the game began'));
      renderer.setAnimationLoop((time, frame) => {
        if (frame) resolve(this.deviceOf(frame));
      });
    });
  }

  deviceOf(frame) {
    return timeOf(frame, 0) - performance.now() >= kPredicted ? 'predicting-webxr' : 'generic-webxr';
  }

  /** Plays until the session ends. */
  play(game, device) {
    this.game = game;
    this.device = device;
    this.room.renderer.setAnimationLoop((time, frame) => {
      try {
        if (frame) this.frame(time, frame);
      } catch (error) {
        this.onTrouble(error);
      }
    });
  }

  end() {
    this.session?.end().catch(() => {});  // it may have ended by itself
  }

  ended() {
    const { renderer } = this.room;
    removeEventListener('keydown', this.keys);
    renderer.setAnimationLoop(null);
    renderer.xr.enabled = false;
    this.session = null;
    this.room.thin(this.room.software);
    if (this.head) this.room.putRig(this.game.view, this.game.X_WT);
    this.onEnd();
  }

  /** From here on, poses count from below the viewer, who looks along -z. */
  recentre(frame) {
    const pose = frame.getViewerPose(this.floor);
    if (!pose) return;
    const { position: p, orientation: q } = pose.transform;
    const yaw = Math.atan2(2 * (q.x * q.z + q.w * q.y), 1 - 2 * (q.x * q.x + q.y * q.y));
    const q_FT = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), yaw);
    const X_FT = new Matrix4().compose(new Vector3(p.x, 0, p.z), q_FT, new Vector3(1, 1, 1));
    this.X_TF = X_FT.clone().invert();
    this.game.note('recentred', JSON.stringify({ X_FT: poseOf(X_FT) }));
  }

  /** The pose in T of what a transform has in F. */
  inT(transform) {
    return poseOf(new Matrix4().multiplyMatrices(this.X_TF, new Matrix4().fromArray(transform.matrix)));
  }

  /** What it is played with. */
  tell(frame) {
    const { session } = this;
    const pose = frame.getViewerPose(this.floor);
    if (!pose) return;
    this.told = true;
    this.period = 1000 / (session.frameRate ?? this.json.frame_hz);
    this.game.note('played_with', JSON.stringify({
      device: this.device,
      browser: navigator.userAgent,
      inputs: [...session.inputSources].map(({ handedness, profiles }) => ({ handedness, profiles })),
      frame_rate_hz: session.frameRate ?? null,
      frame_rates_hz: [...session.supportedFrameRates ?? []],
      views: pose.views.map((view) => described(view, pose, session.renderState.baseLayer?.getViewport(view) ?? {})),
    }));
  }

  isPlayed({ handedness }) {
    return handedness === (this.game.leftHand ? 'left' : 'right');
  }

  /** Controllers may come after the first frame, go, and turn into hands. */
  changed({ removed }) {
    if (!this.game) return;
    this.told = false;
    if ([...removed].some((input) => this.isPlayed(input))) this.letGo();
  }

  /** Nothing is pressed any more: nobody would tell when it is released. */
  letGo() {
    this.pressed.clear();
    [this.forward, this.backward] = [false, false];
    this.tellButtons(this.game.now());
  }

  trigger({ inputSource, frame, timeStamp }, name, down) {
    if (!this.game || !this.isPlayed(inputSource)) return;
    if (down) this.pressed.add(name);
    else this.pressed.delete(name);
    this.tellButtons(this.game.at(timeOf(frame, timeStamp)));
  }

  /** Poses are predicted; what is pressed has happened. */
  tellButtons(time) {
    this.game.buttons({ left: this.forward === true, right: this.backward === true, trigger: this.pressed.size > 0 },
      Math.min(time, this.game.now()));
  }

  readStick({ gamepad }, time) {
    const axis = gamepad?.axes[3] ?? 0;
    [this.forward, this.backward] = [axis < -kStick, axis > kStick];
    this.tellButtons(time);
  }

  /** Whether a controller's lower button or the key was pressed since the last frame. */
  wantsRecentre(inputs) {
    const down = inputs.some(({ gamepad }) => gamepad?.buttons[kRecentre]?.pressed);
    const wanted = this.asked || (down && !this.recentreDown);
    this.recentreDown = down;
    this.asked = false;
    return wanted;
  }

  sample(station, pose, time) {
    if (!pose) return;
    const estimated = pose.emulatedPosition === true;
    if (!estimated) this.tracked.add(station);
    // Some browsers call every place estimated, also a tracked one. It then tells nothing.
    this.game.tracker(station, this.inT(pose.transform), time, estimated && this.tracked.has(station));
    if (!estimated || this.estimated.has(station)) return;
    this.estimated.add(station);
    this.game.note('source_amiss', `station ${station}: its place is the headset's estimate, from here or from time to time`);
  }

  frame(time, frame) {
    const { game, room, session } = this;
    const inputs = [...session.inputSources];
    if (!this.X_TF || this.wantsRecentre(inputs)) this.recentre(frame);
    if (!this.X_TF) return;  // it is not tracked yet
    if (!this.told) this.tell(frame);
    const valid = game.at(timeOf(frame, time));
    const viewer = frame.getViewerPose(this.floor);
    this.sample(1, viewer, valid);
    if (viewer) this.head = this.inT(viewer.transform);
    for (const input of inputs) {
      const station = kStations[input.handedness];
      if (!station || !input.gripSpace) continue;
      this.sample(station, frame.getPose(input.gripSpace, this.floor), valid);
      if (this.isPlayed(input) && session.visibilityState === 'visible') this.readStick(input, valid);
    }
    const view = game.advance();
    room.put(view);
    room.putRig(view, game.X_WT, this.X_TF);
    room.renderer.render(room.scene, room.camera);
    if (viewer) this.tellFrame(viewer, time);
  }

  /** Keeps where the eyes were, and draws less while frames come late. */
  tellFrame(viewer, time) {
    const { room } = this;
    room.rig.updateMatrixWorld();
    const eyes = viewer.views.slice(0, 2).map(({ transform }) =>
      poseOf(new Matrix4().multiplyMatrices(room.rig.matrixWorld, new Matrix4().fromArray(transform.matrix))));
    const late = this.drawnAt !== undefined && time - this.drawnAt > 1.5 * this.period;
    this.drawnAt = time;
    this.game.frame([eyes[0], eyes[1] ?? eyes[0]], late);
    this.late.push(late);
    if (this.late.length > kWatched) this.late.shift();
    if (this.late.filter(Boolean).length > kMostLate) {
      room.thin(true);  // until the headset is put away
      this.late = [];
    }
  }
}
