// The page of a game: a room, one session at a time, and the logs that are kept.
import { block, hasBlock, jsonBlock, numbersOf } from '../data.js';
import { find, make } from '../elements.js';
import { Game } from './game.js';
import { HandByPointer } from './hand.js';
import { answersSoFar, ask } from './questions.js';
import { inView, poseOf, Room } from './scene.js';
import { newKey, Sender } from './sender.js';
import { Sound } from './sound.js';
import { keptLogs, removeLog, save, Store } from './store.js';
import { XrPlay, xrOffered } from './xr.js';

const kPiece = 400;  // ms between pieces of the log: a crash loses less than a second

async function startEngine() {
  const code = new TextDecoder().decode(await block('engine-js'));
  const script = document.createElement('script');
  script.textContent = `${code}\nwindow.headpinEngine = headpinEngine;`;
  document.body.append(script);
  return window.headpinEngine({ wasmBinary: await block('engine-wasm') });
}

function scoreInWords({ skittles_down: down, sheets }) {
  return sheets.length > 0 ? sheets[sheets.length - 1] : `Skittles down: ${down}`;
}

/** What the whole game came to, of each version. */
function endInWords({ skittles_down: down, sheets, last_over: over, unplayed }) {
  const left = sheets.length > 0 && unplayed.length > 0 ? ` The ${unplayed.join(' and the ')} version was not played.` : '';
  const begun = (over || sheets.length === 0 ? 'The game is over.' : 'The game was ended before its last frame.') + left;
  return `${begun} ${sheets.length > 0 ? sheets.join('; ') : `Skittles down: ${down}`}.`;
}

/** What begins a version that has not been played yet. */
const touchNext = (colour) =>
  `This version is over. Press on the ${colour} ball: the next version begins. Or press the key ${colour[0].toUpperCase()}.`;

const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

class Page {
  key = newKey();  // of this page, for the server
  inMemory = [];  // games that the browser has not stored: {name, log, saved}
  cutShort = new Set();  // their names: of each, the list of files may have the beginning, also without a mark

  async open() {
    const json = await jsonBlock('play');
    this.json = json;
    find('title').textContent = `Play: ${json.scenario.name}`;
    find('version').textContent = json.version;
    find('buttons-note').hidden = json.buttons.length === 0;
    const sections = new Map(json.sections.map((section) => [section.name, section]));
    const numbers = numbersOf(await block('play-numbers'), json.sections);
    this.room = new Room(find('view'), { json, numbers, sections });
    this.engine = await startEngine();
    find('start').addEventListener('click', () => this.once(() => this.playHere()));
    find('vr').addEventListener('click', () => this.once(() => this.playWithHeadset()));
    find('end').addEventListener('click', () => this.guard(this.end()));
    this.offerSound();
    addEventListener('beforeunload', (event) => {
      if (this.game || this.asking || this.isUnsaved() || this.isSending()) event.preventDefault();
    });
    this.showGuest();
    this.showRoom();
    addEventListener('resize', () => this.drawStill());
    await this.listFiles();
    await this.lookForHeadset();
    document.documentElement.dataset.ready = 'yes';
    if (this.json.guest?.ended) await this.goOnAsking();
  }

  /** The button and the key that turn the sound off and on. */
  offerSound() {
    this.sound = new Sound();
    const button = find('mute');
    button.hidden = find('sound-note').hidden = !this.json.sound;
    if (!this.json.sound) return;
    const turn = () => {
      this.sound.mute(!this.sound.muted);
      button.setAttribute('aria-pressed', String(this.sound.muted));
    };
    button.addEventListener('click', turn);
    addEventListener('keydown', (event) => {
      const elsewhere = event.target.matches?.('input') || event.ctrlKey || event.altKey || event.metaKey;
      if (event.key.toLowerCase() === 'm' && !event.repeat && !elsewhere) turn();
    });
  }

  async lookForHeadset() {
    const offered = await xrOffered();
    find('vr').hidden = !offered;
    find('no-vr').textContent = offered ? '' : 'No headset is connected to this browser.';
  }

  /** What a page of `headpin serve` says otherwise. */
  showGuest() {
    const { guest } = this.json;
    if (!guest) return;
    find('network').textContent = 'This page sends the game to the computer that it came from.';
    find('who').hidden = guest.participant !== '';
    if (guest.ended) this.tellEnded();
    else if (guest.hint) find('hint').textContent = `${guest.hint} Press Play here.`;
  }

  tellEnded() {
    this.offerNoGame();
    find('hint').textContent = answersSoFar.read().key ? 'The game is over. Please answer the questions.'
      : 'This link was used already; ask for another one.';
  }

  isUnsaved() {
    return this.inMemory.some(({ saved }) => !saved);
  }

  isSending() {
    return this.sender !== undefined && !this.sender.over;
  }

  tellSent() {
    const { sent, made, trouble, over, failed } = this.sender;
    const note = find('sent');
    note.hidden = false;
    note.textContent = over && !failed ? `All is sent: ${megabytes(sent)}.`
      : `Sent: ${megabytes(sent)} of ${megabytes(made)}. ${trouble}`;
  }

  /** The room before a game. */
  showRoom() {
    const game = new Game(this.engine, this.json, { device: 'mouse' });
    this.room.put(game.view);
    this.room.putRig(game.view, game.X_WT);
    this.room.scene.updateMatrixWorld();
    const hand = new HandByPointer(game, this.room, find('view'));
    hand.end();
    this.X_TD = hand.head();
    this.drawStill();
  }

  /** The room while no game goes on. */
  drawStill() {
    if (!this.game && !this.room.renderer.xr.isPresenting) this.room.draw(this.X_TD);
  }

  /** Shows the controls of a game, or those before one. */
  showControls(playing) {
    find('before').hidden = playing;
    find('during').hidden = !playing;
    document.documentElement.toggleAttribute('data-playing', playing);
    this.drawStill();
  }

  async begin(device) {
    if (this.json.sound) this.sound.begin();
    const leftHand = document.querySelector('#hands input:checked').value === 'left';
    const { guest } = this.json;
    const participant = guest?.participant || find('participant').value.trim();
    this.trouble = '';
    this.foul = false;
    this.store = new Store(participant, (why) => this.notStored(why));
    await this.store.start();
    try {
      if (this.store.failed && this.json.not_stored === 'ends') throw new Error(this.trouble);
      if (guest) await this.beginSending();
      this.game = new Game(this.engine, this.json,
        { device, leftHand, participant, condition: guest?.condition,
          keep: (piece) => this.keep(piece), hear: (samples) => this.sound.play(samples) });
    } catch (error) {
      await this.store.discard();
      throw error;
    }
    this.forgetLast();
    if (this.trouble) this.game.note('not_stored', this.trouble);
    this.game.onNews((news) => this.tellNews(news));
    this.pieces = setInterval(() => { this.game.keepLog(); this.tellKept(); }, kPiece);
    this.showControls(true);
    this.room.playWith(leftHand);
    this.room.board.put([]);
    this.room.putRings({ ball: 0, each: [] });
    find('score').textContent = '';
    return this.game;
  }

  /** A link is for one game: the next one of this page would go into the same log. */
  async beginSending() {
    if (this.sender) throw new Error('this link was used already; ask for another one');
    const sender = new Sender(this.key, () => this.tellSent());
    await sender.begin();
    this.sender = sender;
  }

  /** The game is in memory alone from now on, or ends. */
  notStored(why) {
    const ends = this.json.not_stored === 'ends';
    this.trouble = ends ? why
      : `${why} You can go on. The game is kept in memory: do not close the page before you have saved it.`;
    this.game?.note('not_stored', this.trouble);
    this.tellKept();
    if (this.game && ends) this.guard(this.end());
  }

  keep(piece) {
    this.store.add(piece);
    this.sender?.add(piece);
  }

  async playHere() {
    const game = await this.begin('mouse');
    game.note('played_with', JSON.stringify({ device: 'mouse', browser: navigator.userAgent }));
    this.hand = new HandByPointer(game, this.room, find('view'));
    find('view').focus();
    this.tellNext();
    const draw = () => {
      if (this.game !== game) return;
      requestAnimationFrame(draw);
      this.guard(this.drawHere());
    };
    draw();
  }

  /** A picture: the hand's samples, the ticks that are due, and what they made. */
  async drawHere() {
    const { game, hand, room } = this;
    hand.frame();
    const view = game.advance();
    room.put(view);
    room.putRig(view, game.X_WT);
    this.X_TD = hand.head();
    room.draw(this.X_TD);
    const { matrixWorld } = room.camera;
    game.frame([poseOf(matrixWorld), poseOf(matrixWorld)], this.isLate());
    this.tellNext();
  }

  isLate() {
    const now = performance.now();
    const late = this.drawnAt !== undefined && now - this.drawnAt > 1.5 * (1000 / this.json.frame_hz);
    this.drawnAt = now;
    return late;
  }

  async playWithHeadset() {
    const xr = new XrPlay(this.room, this.json);
    await xr.request();  // first, while the browser still knows of the click
    this.xr = xr;
    xr.onTrouble = (error) => this.fail(error);
    const device = await xr.start();
    const game = await this.begin(device);
    find('hint').textContent = 'You are playing with the headset.';
    xr.onEnd = () => this.guard(this.end());
    xr.play(game, device);
  }

  async end() {
    const { game } = this;
    if (!game) return;
    const result = game.finish();  // where it fails, fail() keeps the game
    this.game = null;
    clearInterval(this.pieces);
    this.sound.end();
    this.hand?.end();
    this.hand = null;
    this.X_TD = this.xr?.head ?? this.X_TD;
    this.xr?.end();
    this.xr = null;
    await this.keepLast(result);
    find('hint').textContent = endInWords(game.score);
    find('score').textContent = '';
    find('save-last').focus();
    await this.endVisit();
  }

  /** The log of the game that ended is whole: it can be saved. */
  async keepLast(result) {
    const { store } = this;
    const log = await store.finish();
    this.last = { ...result, name: store.name, log, saved: false };
    if (store.failed) {
      this.inMemory.push(this.last);
      this.cutShort.add(store.name);
    }
    this.showControls(false);
    this.tellEnd();
    await this.listFiles();
  }

  /** A link is for one game; what a study asks comes after it. */
  async endVisit() {
    if (!this.sender) return;
    this.offerNoGame();
    const { questions } = this.json.guest;
    if (questions) answersSoFar.keep({ key: this.key });
    await this.sender.finish();
    if (questions && this.sender.failed) this.tellNotAsked();
    else if (questions) await this.askQuestions();
  }

  tellNotAsked() {
    find('questions').hidden = false;
    find('questions-body').replaceChildren(make('p', {},
      'The questions are not asked here, as the game could not be sent. Save the game, and tell the people who invited you.'));
  }

  offerNoGame() {
    for (const id of ['start', 'vr']) find(id).disabled = true;
  }

  async askQuestions() {
    this.asking = true;
    await ask(this.json.guest.questions, (answers) => this.sender.answer(answers));
    this.asking = false;
  }

  /** The page was loaded again after the game: its questions, for the tab that played. */
  async goOnAsking() {
    const { key } = answersSoFar.read();
    if (!key) return;
    this.sender = new Sender(key, () => {});
    this.sender.over = true;
    await this.askQuestions();
  }

  /** Another game has begun: its news take the place of the last one, which waits in a list until it is saved. */
  forgetLast() {
    this.last = null;
    this.inMemory = this.inMemory.filter(({ saved }) => !saved);
    this.listInMemory();
    this.listFiles();  // the game does not wait for it
  }

  /** The games before the last one that are in memory alone, each with its button. */
  listInMemory() {
    const rows = this.inMemory.filter((game) => game !== this.last)
      .map((game) => make('li', {}, `${game.name}, ${megabytes(game.log.size)} `, ...this.saveButton(game, {},
        'Save ', make('span', { class: 'hidden' }, game.name))));
    find('in-memory').hidden = rows.length === 0;
    find('in-memory-body').replaceChildren(...rows);
  }

  /** A button that saves a game, and the place where it says so. */
  saveButton(game, attributes, ...words) {
    const said = make('span');
    const button = make('button', { type: 'button', ...attributes, onclick: () => {
      save(game.name, game.log);
      game.saved = true;
      said.textContent = ' Saved.';
    } }, ...words);
    return [button, said];
  }

  tellEnd() {
    const { name, log } = this.last;
    const button = this.saveButton(this.last, { id: 'save-last' }, `Save the game (${megabytes(log.size)})`);
    find('kept').replaceChildren(`${this.trouble} `.trimStart(), ...button, ` Then: headpin replay ${name} --verify`);
  }

  tellNews({ score, board, rings, events }) {
    this.room.board.put(board);
    this.room.putRings(rings);
    for (const { kind } of events) {
      if (kind === 'foul') this.foul = true;
      if (kind === 'grab') this.foul = false;
    }
    const words = scoreInWords(score);
    if (find('score').textContent !== words) find('score').textContent = words;
  }

  tellKept() {
    if (this.game) find('kept').textContent = this.trouble || `Stored so far: ${megabytes(this.store.stored)}.`;
  }

  /** What the player should do now. */
  tellNext() {
    const hint = this.next();
    if (find('hint').textContent !== hint) find('hint').textContent = hint;
  }

  next() {
    const { game: { view, score, json }, hand } = this;
    if (view[inView.held] > 0) {
      return hand.swing?.byKeys ? 'Let the space bar go: the hand swings, and throws.'
        : 'Swing: move quickly up, and let go while you move.';
    }
    if (score.last_over && !score.over) return touchNext(score.unplayed[0]);
    if (score.over) return 'The game is over. End it, and save it.';
    if (json.buttons.length > 0 && score.sheets.length === 0) return this.json.guest?.hint || 'Press on the red or the blue ball: a game begins. Or press the key R or B.';
    const foul = this.foul ? 'You let go beyond the foul line. Let go earlier. ' : '';
    if (hand.balls().length > 0) return `${foul}Press on the ball and hold. Or hold the space bar.`;
    return foul + (score.sheets.length > 0 ? 'Wait: the ball comes back.' : 'The ball is thrown. End the game, and save it.');
  }

  /** Of lists that are asked for meanwhile, the newest is shown. */
  async listFiles() {
    this.lists = (this.lists ?? 0) + 1;
    const mine = this.lists;
    const logs = await keptLogs();
    if (mine !== this.lists) return;
    const rows = logs.map(({ name, file, playing, cut: marked }) => {
      const row = make('li', {}, `${name}, ${megabytes(file.size)} `);
      const cut = marked || this.cutShort.has(name);
      if (cut) row.append(`(only its beginning${this.inMemory.some((game) => game.name === name) ? '; the whole game is above' : ''}) `);
      const saved = cut ? name.replace(/\.lcmlog$/, '-beginning.lcmlog') : name;
      if (playing) row.append('(is being played)');
      else row.append(
        make('button', { type: 'button', onclick: () => save(saved, file) }, 'Save ', make('span', { class: 'hidden' }, saved)),
        make('button', { type: 'button', onclick: () => this.remove(name) }, 'Delete ', make('span', { class: 'hidden' }, name)));
      return row;
    });
    find('files-body').replaceChildren(rows.length ? make('ul', {}, ...rows) : make('p', {}, 'None.'));
  }

  /** What goes wrong here is no trouble of a game. */
  async remove(name) {
    if (!confirm(`Delete ${name}? It cannot be brought back.`)) return;
    let said = '';
    try {
      await removeLog(name);
    } catch (error) {
      said = `${name} was not deleted: ${error.message}.`;
    }
    find('files-trouble').textContent = said;
    await this.listFiles();
  }

  /** Begins a game, and no second one meanwhile. */
  async once(play) {
    if (this.beginning || this.game) return;
    this.beginning = true;
    find('trouble').hidden = true;
    await this.guard(play());
    this.beginning = false;
  }

  async guard(work) {
    try {
      await work;
    } catch (error) {
      this.fail(error);
    }
  }

  /** What went wrong; the log up to here is kept. */
  fail(error) {
    find('trouble').hidden = false;
    find('trouble').textContent = `The game stopped: ${error.message}`;
    const { game } = this;
    this.game = null;
    clearInterval(this.pieces);
    this.sound?.end();
    this.hand?.end();
    this.hand = null;
    this.xr?.end();
    this.xr = null;
    if (!game) return;
    try {
      game.keepLog();
    } catch {
      // The engine gives no more: what it gave before is kept.
    }
    find('hint').textContent = '';
    this.keepLast({}).then(() => this.endVisit()).catch(() => {});  // the first trouble is told already
  }
}

const page = new Page();
window.headpin = page;  // for those who look from the console, and for tests
page.open().catch((error) => {
  find('trouble').hidden = false;
  find('trouble').textContent = hasBlock('play') ? `This page cannot show the game: ${error.message}`
    : 'This file is a template: headpin play fills it.';
  throw error;
});
