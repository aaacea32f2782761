// The operator's view of `headpin serve`: who plays, how it goes, and the room from outside.
import { PerspectiveCamera } from 'three';

import { block, hasBlock, jsonBlock, numbersOf } from '../data.js';
import { find, make, table } from '../elements.js';
import { inView, poseOf, Room } from '../play/scene.js';

const kEvery = 250;  // ms between questions
const kSilent = 3;   // s without a piece of the log, that are worth a word
const kPose = 7;
const kHead = ['Guest', 'State', 'Tick', 'Score', 'Frames a second', 'Tracking', 'Log', 'Link'];

const token = new URLSearchParams(location.search).get('token');

/** From behind and above the player, to the pins. */
function viewpoint({ room, X_WT }) {
  const camera = new PerspectiveCamera();
  camera.up.set(0, 0, 1);
  camera.position.set(X_WT[4] + 1.3, X_WT[5] - 2.2, 2.3);
  camera.lookAt(X_WT[4], X_WT[5] + 4, 0.4);
  camera.updateMatrixWorld();
  return poseOf(camera.matrixWorld);
}

async function asked(path, options, query = '') {
  const answer = await fetch(`${path}?token=${token}${query}`, options);
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}

function scoreOf({ sheets, skittles_down: down }) {
  return sheets.length > 0 ? sheets[sheets.length - 1] : `${down} down`;
}

function trackingOf({ lost_now: lost, times_lost: times }) {
  if (lost.length > 0) return `${lost.join(', ')} is lost now`;
  return times === 0 ? 'no gaps' : `${times} ${times === 1 ? 'gap' : 'gaps'}`;
}

function stateOf({ state, answered, silent_s: silent, trouble }) {
  if (trouble) return trouble;
  if (state === 'playing' && silent > kSilent) return `nothing came for ${Math.round(silent)} s`;
  return state === 'ended' && answered ? 'ended, has answered' : state;
}

class Watch {
  async open() {
    const json = await jsonBlock('play');
    this.json = json;
    find('title').textContent = `Operator: ${json.scenario.name}`;
    find('version').textContent = json.version;
    const sections = new Map(json.sections.map((section) => [section.name, section]));
    this.room = new Room(find('view'), { json, numbers: numbersOf(await block('play-numbers'), json.sections), sections });
    this.head = this.room.actor(json.actors.find(({ role }) => role === 'head'));
    this.bodies = json.actors.filter(({ role }) => role === 'skittle' || role === 'ball');
    this.X_WC = viewpoint(json);
    this.watched = null;  // the token of the guest who is drawn
    this.rows = new Map();  // of the guests, by their tokens
    find('guests').replaceChildren(table('Who has a link', kHead, []));
    find('new-link').addEventListener('click', () => this.makeLink());
    for (;;) {
      await this.tryToLook();
      document.documentElement.dataset.ready = 'yes';
      await new Promise((resolve) => { setTimeout(resolve, kEvery); });
    }
  }

  async tryToLook() {
    try {
      await this.look();
      find('trouble').hidden = true;
    } catch (error) {
      find('trouble').hidden = false;
      find('trouble').textContent = `The server does not answer: ${error.message}`;
    }
  }

  /**
   * Says the new link, or why there is none: nobody shall get the one before.
   * @param again  the token of a guest whose game was cut off: the link is for the same participant
   */
  async makeLink(again = '') {
    const said = find('link');
    said.replaceChildren();
    try {
      const { path, participant } = await asked('/links', { method: 'POST' }, again && `&again=${again}`);
      const url = `${location.origin}${path}`;
      said.replaceChildren(`The new link${participant ? `, for ${participant}` : ''}: `, make('a', { href: url }, url));
    } catch (error) {
      said.replaceChildren(`No link was made: ${error.message}`);
    }
  }

  async look() {
    const { guests } = await asked('/state');
    this.list(guests);
    const playing = guests.filter(({ game }) => game);
    const shown = playing.find(({ token: its }) => its === this.watched)
      ?? playing.find(({ state }) => state === 'playing') ?? playing[playing.length - 1];
    find('now').textContent = shown ? `${this.nameOf(shown)}: ${scoreOf(shown.game)}` : 'Nobody plays.';
    this.draw(shown?.game);
  }

  nameOf({ participant, game, token: its }) {
    return participant || game?.participant || `guest ${its.slice(0, 4)}`;
  }

  list(guests) {
    for (const guest of guests) {
      const { game, bytes = 0, file = '' } = guest;
      const texts = [this.nameOf(guest), stateOf(guest), game ? String(game.tick) : '', game ? scoreOf(game) : '',
        game ? game.frame_rate_hz.toFixed(0) : '', game ? trackingOf(game) : '',
        game ? `${file}, ${(bytes / 1e6).toFixed(1)} MB` : ''];
      const row = this.rowOf(guest);
      texts.forEach((text, i) => { if (row.cells[i].textContent !== text) row.cells[i].textContent = text; });
      if (guest.state === row.state) continue;
      row.state = guest.state;
      row.cells[texts.length].replaceChildren(...this.linkOrButtons(guest));
    }
  }

  /** The row of a guest. It stays while its texts change, so that what is in it can be clicked. */
  rowOf({ token: its }) {
    if (!this.rows.has(its)) {
      const cells = kHead.map((_, i) => (i === 0 ? make('th', { scope: 'row' }) : make('td')));
      find('guests').querySelector('tbody').append(make('tr', {}, cells));
      this.rows.set(its, { cells, state: null });
    }
    return this.rows.get(its);
  }

  linkOf({ token: its }) {
    const url = `${location.origin}/play/${its}`;
    return make('a', { href: url, id: `link-${its}` }, url);
  }

  linkOrButtons(guest) {
    if (guest.state === 'invited') return [this.linkOf(guest)];
    const again = guest.state === 'playing' && guest.participant;
    return again ? [this.buttonOf(guest), ' ', this.againOf(guest)] : [this.buttonOf(guest)];
  }

  /** For a participant whose game was cut off. */
  againOf({ token: its }) {
    return make('button', { type: 'button', id: `again-${its}`, onclick: () => this.makeLink(its) }, 'Another link');
  }

  buttonOf({ token: its }) {
    return make('button', { type: 'button', id: `watch-${its}`, onclick: () => { this.watched = its; } }, 'Watch');
  }

  /** What PageSession::see would say of this state. */
  viewOf({ bodies, head, hand, ellipsoids, closed }) {
    const view = new Float32Array(inView.bodies + kPose * this.bodies.length);
    const put = (at, pose) => view.set(pose ?? [1, 0, 0, 0, 0, 0, 0], at);
    view[inView.ellipsoids] = ellipsoids ? 1 : 0;
    view[inView.closed] = closed;
    view[inView.handSeen] = hand ? 1 : 0;
    put(inView.X_WP, null);
    put(inView.X_WH, hand);
    put(inView.X_WD, head);
    this.bodies.forEach(({ name }, i) => put(inView.bodies + kPose * i, bodies[name]));
    return view;
  }

  draw(game) {
    const { room } = this;
    if (game && Object.keys(game.bodies).length > 0) {
      room.playWith(game.left_hand);
      room.put(this.viewOf(game));
      if (game.head) room.show(this.head, 0, game.head);
    }
    room.draw(this.X_WC);
  }
}

const watch = new Watch();
window.headpin = watch;
watch.open().catch((error) => {
  find('trouble').hidden = false;
  find('trouble').textContent = hasBlock('play') ? `This page cannot show the room: ${error.message}`
    : 'This file is a template: headpin serve fills it.';
  throw error;
});
