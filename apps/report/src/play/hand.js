// The virtual hand without a headset: a pointer or keys move it, and the pose of the head stays where
// the player stands. All poses are in the tracked space T: x right, y up, z back.
import { Quaternion, Vector3 } from 'three';

import { inView, poseAt } from './scene.js';

const kEyeHeight = 1.75, kEyeBehind = 1.4;  // m: so far behind that ball and skittles are in the picture
const kFromWall = 0.75;           // m that the ball's stand and the wall behind need of the room
const kLookDown = 0.38;           // rad
const kTurn = 0.35;               // rad/s, while a key is down
const kNear = 0.2;                // m from the pointer's ray: the hand goes there
const kReached = 3;               // m from the eye, beyond which the hand goes nowhere
const kHover = -0.2;              // z of the hand that is nowhere [m]
const kForward = 1.9, kAcross = 0.9;  // m that the swinging hand moves for the picture's height
const kDrawnBack = 0.7;           // m behind the stand, where a swing begins: long before the foul line
const kDrawBack = 100_000;        // us, the time in which it is drawn back to 1/e
const kLow = 0.2;                 // height of the ball's centre where it is let go [m]
const kLowered = 0.2;             // m ahead, from where it was farthest back, in which it gets there: slowly yet
const kQuiet = 50_000;            // us after which no more moves of the pointer are heard of
const kSilent = 60_000;           // us after a release: what the pointer does then is no swing
const kStep = 8_000;              // us between samples of a hand that keys move
const kWay = 0.85;                // m of a swing by keys
const kSlowest = 4, kFastest = 8; // m/s of that swing

const kTouch = 50_000;            // us that a button is touched at least
const kFront = 0.35;              // m before a button, from where the hand goes there

const identity = [1, 0, 0, 0];
const inFront = ([x, y, z]) => [x, y, z + kFront];
const smooth = (s) => (s <= 0 ? 0 : s >= 1 ? 1 : s * s * (3 - 2 * s));

export class HandByPointer {
  constructor(game, room, canvas) {
    this.game = game;
    this.room = room;
    this.canvas = canvas;
    this.middle = -game.X_WT[4];  // x of the lane's middle, where the player stands and swings
    this.yaw = 0;
    this.keys = new Set();
    this.pointer = null;   // [x, y] on the canvas, -1 to 1, y up
    this.swing = null;     // while something is taken
    this.touched = null;   // the place of the button that is pressed
    this.finger = null;    // the pointer that is down
    this.silentUntil = 0;
    this.framed = 0;
    this.place = [this.middle + 0.3, 1.0, kHover];
    this.sent = -kStep;  // us: the time of the latest sample of the hand
    this.abort = new AbortController();
    this.listen();
  }

  listen() {
    const on = (target, kind, act) => target.addEventListener(kind, act, { signal: this.abort.signal });
    on(this.canvas, 'pointermove', (event) => this.moved(event));
    on(this.canvas, 'pointerdown', (event) => this.pressed(event));
    on(this.canvas, 'pointerup', (event) => this.lifted(event));
    on(this.canvas, 'pointercancel', (event) => this.lifted(event));
    on(this.canvas, 'keydown', (event) => this.key(event, true));
    on(this.canvas, 'keyup', (event) => this.key(event, false));
    on(this.canvas, 'blur', () => this.letKeysGo());
  }

  end() {
    this.abort.abort();
  }

  /** X_TD */
  head() {
    const q = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), this.yaw)
      .multiply(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -kLookDown));
    const behind = Math.min(kEyeBehind, this.game.json.room.behind - kFromWall);
    return [q.w, q.x, q.y, q.z, this.middle, kEyeHeight, behind];
  }

  /** A point of the world in T. */
  inT(p) {
    return this.room.rig.worldToLocal(new Vector3(...p));
  }

  /** Balls that can be reached, the nearest first, and where the hand would grab each. */
  balls() {
    const { json, view, grip } = this.game;
    const [, , , , ...eye] = this.head();
    const away = ({ at }) => at.distanceTo(new Vector3(...eye));
    return json.actors.flatMap(({ role }, i) => (role === 'ball' ? [poseAt(view, inView.bodies + 7 * i).subarray(4)] : []))
      .map((p) => ({ at: this.inT(p), hand: this.inT(p).sub(new Vector3(...grip)) }))
      .filter((ball) => away(ball) < kReached)
      .sort((a, b) => away(a) - away(b));
  }

  /** The buttons; the hand goes there only where one is pressed. */
  buttons() {
    return this.game.json.buttons.map(({ colour, p }) => ({ colour, at: this.inT(p), hand: this.inT(p) }));
  }

  /** The pointer's ray in T. */
  ray() {
    const { camera, rig } = this.room;
    const from = rig.worldToLocal(camera.getWorldPosition(new Vector3()));
    const through = rig.worldToLocal(new Vector3(...this.pointer, 0.5).unproject(camera));
    return { from, along: through.sub(from).normalize() };
  }

  /** What the pointer is at, of places; undefined where there is none. */
  pointedAt(places) {
    const { from, along } = this.ray();
    const off = ({ at }) => at.clone().sub(from).cross(along).length();
    return places.filter((place) => off(place) < kNear).sort((a, b) => off(a) - off(b))[0];
  }

  /** Where the hand is for a pointer that takes nothing. */
  hovering() {
    if (!this.pointer) return this.place;
    const near = this.pointedAt(this.balls());
    if (near) return near.hand.toArray();
    const { from, along } = this.ray();
    const far = along.z < -0.05 ? Math.min((kHover - from.z) / along.z, kReached) : kReached;
    const p = from.addScaledVector(along, far);
    return [Math.max(this.middle - 1.2, Math.min(this.middle + 1.2, p.x)), Math.max(0.15, Math.min(2.2, p.y)), p.z];
  }

  /** Where the hand is in a swing, for the pointer's way since it was pressed, in picture heights. */
  swinging(across, up, time) {
    const { from, began, back } = this.swing;
    const drawn = 1 - Math.exp(-(time - began) / kDrawBack);
    const forward = kForward * up;
    const centre = from.y + this.game.grip[1];
    this.swing.back = Math.min(back, forward);
    const lower = (centre - kLow) * smooth((forward - this.swing.back) / kLowered);
    const lift = forward < 0 ? 0.15 * forward * forward : 0;
    const ahead = forward - kDrawnBack * drawn;
    const side = kAcross * across;
    return [from.x + (this.middle - from.x) * drawn + side * Math.cos(this.yaw) - ahead * Math.sin(this.yaw),
      from.y - lower + lift,
      from.z - ahead * Math.cos(this.yaw) - side * Math.sin(this.yaw)];
  }

  sendHand(place, time) {
    this.place = place;
    this.sent = Math.max(this.sent, time);
    this.game.tracker(this.game.handStation, [...identity, ...place], time);
  }

  locate(event) {
    const box = this.canvas.getBoundingClientRect();
    return [(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height];
  }

  /** Where the hand is now that the pointer is there. */
  follow(at, time) {
    this.pointer = at;
    this.pointed = time;
    if (time < this.silentUntil || this.swing?.byKeys) return;
    if (this.touched) return this.sendHand(this.touched, time);
    if (!this.swing) return this.sendHand(this.hovering(), time);
    const aspect = this.canvas.clientWidth / this.canvas.clientHeight;
    const [x, y] = this.swing.pointer;
    this.sendHand(this.swinging(((at[0] - x) * aspect) / 2, (at[1] - y) / 2, time), time);
  }

  /** The pointer stood still up to then; the hand may still be drawn back. */
  stay(time) {
    const { pointed } = this;
    this.follow(this.pointer, time);
    this.pointed = pointed;
  }

  moved(event) {
    if (this.finger !== null && event.pointerId !== this.finger) return;
    const parts = event.getCoalescedEvents?.() ?? [];
    for (const part of parts.length ? parts : [event]) this.follow(this.locate(part), this.game.at(part.timeStamp));
  }

  take(time) {
    this.swing = { pointer: this.pointer, from: new Vector3(...this.place), began: time, back: 0 };
    this.press(true, time);
  }

  /** Goes to a button from the front: the straight way may lead through another one. */
  touch(place, time) {
    this.touched = place;
    this.sendHand(inFront(place), time);
    this.sendHand(place, time + kStep);
  }

  /** Goes back to the front. */
  leave(time) {
    const end = Math.max(time, this.sent + kTouch);
    this.sendHand(this.touched, end);
    this.sendHand(inFront(this.touched), end + kStep);
    this.touched = null;
    this.silentUntil = end + kSilent;
  }

  press(trigger, time) {
    this.trigger = trigger;
    this.tellButtons(time);
  }

  pressed(event) {
    if (event.button !== 0 || this.swing || this.touched) return;
    event.preventDefault();
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    this.finger = event.pointerId;
    const time = this.game.at(event.timeStamp);
    this.silentUntil = 0;
    this.pointer = this.locate(event);
    const button = this.pointedAt(this.buttons());
    if (button) return this.touch(button.hand.toArray(), time);
    this.follow(this.pointer, time);
    this.take(time);
  }

  lifted(event) {
    if (event.pointerId !== this.finger) return;
    this.finger = null;
    const time = this.game.at(event.timeStamp);
    if (this.touched) return this.leave(time);
    this.follow(this.locate(event), time);
    this.letGo(time);
  }

  letGo(time) {
    this.press(false, time);
    this.swing = null;
    this.silentUntil = time + kSilent;
  }

  key(event, down) {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const known = ['w', 'a', 's', 'd', 'ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight', ' ', 'r', 'b'];
    if (!known.includes(key) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (event.repeat) return;
    if (down) this.keys.add(key);
    else this.keys.delete(key);
    const time = this.game.at(event.timeStamp);
    if (key === ' ') this.throwKey(down, time);
    if (key === 'r') this.touchKey('red', down, time);
    if (key === 'b') this.touchKey('blue', down, time);
    this.tellButtons(time);
  }

  /** Keys that are let go elsewhere are not heard of: here they count as let go now. */
  letKeysGo() {
    const now = this.game.now();
    if (this.keys.has(' ')) this.throwKey(false, now);
    this.keys.clear();
    if (this.finger === null && this.touched) this.leave(now);
    this.tellButtons(now);
  }

  /** Down: the hand goes to the button of a colour. From here on it is not where the pointer was. */
  touchKey(colour, down, time) {
    if (this.swing || this.finger !== null) return;
    if (this.touched) {
      if (!down) this.leave(time);
      return;
    }
    const button = this.buttons().find((one) => one.colour === colour);
    if (!button || !down) return;
    this.pointer = null;
    this.touch(button.hand.toArray(), time);
  }

  /** Down: takes the nearest ball and draws it back; up: swings, the faster the longer it was down. */
  throwKey(down, time) {
    if (down && !this.swing && !this.touched) {
      const [ball] = this.balls();
      if (!ball) return;
      this.pointer = null;
      const from = Math.max(time, this.sent + kStep);
      this.sendHand(ball.hand.toArray(), from);
      this.take(from);
      this.swing.byKeys = { sent: from };
    } else if (!down && this.swing?.byKeys && !this.swing.byKeys.go) {
      const held = Math.min(1, (time - this.swing.began) / 1e6);
      this.swing.byKeys.go = Math.max(time, this.swing.byKeys.sent);
      this.swing.byKeys.speed = kSlowest + (kFastest - kSlowest) * held;
    }
  }

  /** Samples of a hand that keys move, up to a time. It speeds up evenly until it lets go, with the last of them. */
  keysTo(now) {
    const keys = this.swing.byKeys;
    const takes = (1e6 * 2 * kWay) / keys.speed;
    const end = keys.go === undefined ? Infinity : Math.round(keys.go + takes);
    for (;;) {
      // None comes shortly before the last one: two that are close have no speed.
      const next = keys.sent + 1.5 * kStep < end ? keys.sent + kStep : end;
      if (next > now) return;
      keys.sent = next;
      const s = end === Infinity ? 0 : (next - keys.go) / takes;
      const forward = s > 0 ? kWay * Math.min(s, 1) ** 2 : 0;
      this.sendHand(this.swinging(0, forward / kForward, next), next);
      if (next === end) return this.letGo(end);
    }
  }

  tellButtons(time) {
    const pad = this.pad ?? {};
    this.game.buttons({
      left: this.keys.has('w') || this.keys.has('ArrowUp') || pad.up === true,
      right: this.keys.has('s') || this.keys.has('ArrowDown') || pad.down === true,
      trigger: this.trigger === true,
    }, time);
  }

  readGamepad(now) {
    const pad = navigator.getGamepads?.().find((one) => one?.mapping === 'standard');
    if (!pad) return;
    const before = this.pad ?? {};
    this.pad = { up: pad.axes[1] < -0.5, down: pad.axes[1] > 0.5, throw: pad.buttons[0].pressed,
      red: pad.buttons[1].pressed, blue: pad.buttons[2].pressed, turn: Math.abs(pad.axes[2]) > 0.2 ? -pad.axes[2] : 0 };
    if (this.pad.throw !== (before.throw === true)) this.throwKey(this.pad.throw, now);
    for (const colour of ['red', 'blue']) {
      if (this.pad[colour] !== (before[colour] === true)) this.touchKey(colour, this.pad[colour], now);
    }
    this.tellButtons(now);
  }

  /** Before the ticks of a picture: turns the head, and says where head and hand are. */
  frame() {
    const now = this.game.now();
    this.readGamepad(now);
    const left = this.keys.has('a') || this.keys.has('ArrowLeft');
    const right = this.keys.has('d') || this.keys.has('ArrowRight');
    const turn = Number(left) - Number(right) + (this.pad?.turn ?? 0);
    this.yaw += kTurn * turn * Math.min(0.1, (now - this.framed) / 1e6);
    this.framed = now;
    this.game.tracker(1, this.head(), now);
    if (this.swing?.byKeys) this.keysTo(now);
    else if (!this.pointer && now >= this.silentUntil) this.sendHand(this.place, now);
    else if (now - this.pointed > kQuiet) this.stay(now - kQuiet);
  }
}
