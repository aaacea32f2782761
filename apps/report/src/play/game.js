// A session that is played: samples go in, ticks are made, the log comes out in pieces.
const kMostAtOnce = 250_000;  // us of ticks in one call; what is more is a pause
const kMostAhead = 1_000_000;  // us that a pose may be ahead, as in the log; a browser may give a time that no display has
const kAfterPause = 100_000;  // us of ticks after one: less than after which the tracking counts as lost

const same = (a, b) => a && a.left === b.left && a.right === b.right && a.trigger === b.trigger;

function checked(answer) {
  if (answer.error) throw new Error(answer.error);
  return answer;
}

export class Game {
  /**
   * Begins a session at the time 0.
   * @param engine  the module of engine.js
   * @param json    the page's scenario
   * @param device  'mouse' or 'generic-webxr'
   * @param keep    takes the pieces of the log, as Uint8Array
   * @param hear    takes what the player hears, as Int16Array
   */
  constructor(engine, json, { device, leftHand = false, participant = '', condition = '', keep = () => {}, hear = () => {} }) {
    this.engine = engine;
    this.json = json;
    this.keep = keep;
    this.hear = hear;
    this.leftHand = leftHand;
    this.X_WT = leftHand ? json.left_handed.X_WT : json.X_WT;
    this.grip = leftHand ? json.left_handed.grip : json.hand.grip;
    this.handStation = leftHand ? 3 : 2;
    checked(engine.begin({ scenario: json.scenario.text, device, left_hand: leftHand, participant, condition,
      epoch_us: Math.round(1e3 * Date.now()) }));
    this.start = performance.now();  // ms, of the session's time 0
    this.made = 0;                   // us, up to where ticks are made
    this.latest = new Map();         // device time of each station
    this.frames = 0;
    this.lateFrames = 0;
    this.listeners = [];
    this.score = { skittles_down: 0, sheets: [], last_over: false, over: false, unplayed: json.buttons.map(({ colour }) => colour) };
    this.view = checked(engine.advance(0)).view.slice();
  }

  /** The session's time of a time stamp of the browser's clock [ms], in whole microseconds. */
  at(milliseconds) {
    this.leaveOutPause();
    return Math.max(0, Math.round(1e3 * (milliseconds - this.start)));
  }

  now() {
    return this.at(performance.now());
  }

  /** After a pause the session goes on where it stood: as if the pause had not been. */
  leaveOutPause() {
    const due = 1e3 * (performance.now() - this.start) - this.made;
    if (due <= kMostAtOnce) return;
    this.start += (due - kAfterPause) / 1e3;
    this.note('paused', '', (due - kAfterPause) / 1e6);
  }

  onNews(listener) {
    this.listeners.push(listener);
  }

  /** @param estimated  the device does not track the position now, and tells its estimate */
  tracker(station, pose, deviceTime, estimated = false) {
    const now = this.now();
    const valid = Math.min(deviceTime, now + kMostAhead);
    if (valid <= (this.latest.get(station) ?? -1)) return;
    this.latest.set(station, valid);
    checked(this.engine.tracker(station, valid, now, pose, estimated));
  }

  buttons(state, deviceTime) {
    if (same(this.pressed, state)) return;
    this.pressed = { ...state };
    checked(this.engine.buttons(deviceTime, this.now(), state.left, state.right, state.trigger));
  }

  note(kind, detail, value = 0) {
    checked(this.engine.note(kind, detail, value));
  }

  /** @param late  it came more than half a period too late */
  frame(eyes, late = false) {
    checked(this.engine.frame(this.made, this.frames++, eyes));
    if (late) ++this.lateFrames;
  }

  /** Makes the ticks that are due. */
  advance() {
    const until = this.now();
    const { view, news } = checked(this.engine.advance(until));
    this.made = until;
    this.view.set(view);
    if (this.json.sound) this.hear(checked(this.engine.takeSound()));
    if (news) {
      this.score = news.score;
      for (const listener of this.listeners) listener(news);
    }
    return this.view;
  }

  /** Hands the log's new bytes over. */
  keepLog() {
    const piece = this.engine.takeLog();
    if (piece.length > 0) this.keep(piece);
  }

  /** @return  the hashes and the result */
  finish() {
    const { json } = checked(this.engine.finish(this.frames, this.lateFrames));
    this.keepLog();
    return JSON.parse(json);
  }
}
