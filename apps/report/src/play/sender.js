// Sends a game's log to the machine that the page came from, while it grows.
const kMostAtOnce = 1_000_000;             // bytes of a request
const kLeastAtOnce = 10_000;               // bytes that a slow line still takes in `kSilence`
const kWaits = [250, 500, 1000, 2000, 4000];  // ms before the next try
const kSilence = 15_000;                   // ms, after which a request has failed
const kEnough = 20;                        // requests that arrive before a size that was too large is tried again

const sleep = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

/** By which the server knows this page again. */
export function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** The server has said no. */
class No extends Error {
  /** @param status  of HTTP */
  constructor(why, status) {
    super(why);
    this.status = status;
    this.final = status === 400 || status === 403 || status === 413;  // trying again will not change it
  }
}

/** Throws what is to be told of a request that failed. */
function inWords(error) {
  throw error instanceof No ? error : new Error('the connection is interrupted');
}

export class Sender {
  /**
   * @param key      of the page: a try whose answer was lost begins again with the same one
   * @param onState  told whenever `sent`, `trouble` or `over` changes
   */
  constructor(key, onState) {
    this.key = key;
    this.onState = onState;
    this.pieces = [];
    this.made = 0;       // bytes
    this.sent = 0;       // of them, that are there
    this.atOnce = kMostAtOnce;  // bytes of the next request: fewer after one that failed
    this.tooLarge = Infinity;   // of one that failed
    this.arrived = 0;    // requests since then
    this.trouble = '';   // why nothing gets there now
    this.wake = () => {};
  }

  async post(doing, { at, body } = {}) {
    const query = at === undefined ? '' : `&at=${at}`;
    const answer = await fetch(`${location.pathname}/${doing}?key=${this.key}${query}`,
      { method: 'POST', body, signal: AbortSignal.timeout(kSilence) });
    if (answer.ok) return answer.json();
    throw new No((await answer.text()).trim(), answer.status);
  }

  /** The link is used from now on. @throws  in words, when it was used before or nobody answers */
  async begin() {
    await this.post('begin').catch((error) => {
      if (error instanceof No) throw error;
      throw new Error('the connection is interrupted. Press Play again.');
    });
    this.working = this.work();
  }

  add(piece) {
    this.pieces.push(piece);
    this.made += piece.length;
    this.wake();
  }

  /** All pieces are there, and the log is known to be whole. */
  async finish() {
    this.ending = true;
    this.wake();
    await this.working;
  }

  tell(trouble) {
    this.trouble = trouble;
    this.onState();
  }

  async work() {
    let failures = 0;
    while (!this.over) {
      try {
        await this.step(failures > 0);
        failures = 0;
        if (this.trouble) this.tell('');
      } catch (error) {
        if (error.final) {
          this.over = true;
          this.failed = true;
          this.tell(`Nothing more can be sent: ${error.message}.`);
          return;
        }
        const why = error instanceof No ? error.message : 'the connection is interrupted';
        this.tell(`Nothing is stored there now: ${why}. It will be tried again.`);
        await sleep(kWaits[Math.min(failures++, kWaits.length - 1)]);
      }
    }
  }

  async step(again) {
    // What arrived, although its answer did not, need not be sent again.
    if (again) this.sent = (await this.post('begin')).size;
    if (this.sent < this.made) {
      await this.sendPiece();
      this.onState();
    } else if (this.ending) {
      await this.post('end', { at: this.made });
      this.over = true;
      this.onState();
    } else {
      await new Promise((resolve) => { this.wake = resolve; });
    }
  }

  /**
   * A slow line may take too long for a large piece: the next one is half as large, until one arrives. The size that
   * failed is seldom tried again, as that may take all of kSilence. A small piece that fails was not too large.
   */
  async sendPiece() {
    const body = new Blob(this.pieces).slice(this.sent, this.sent + this.atOnce);
    try {
      this.sent = (await this.post('log', { at: this.sent, body })).size;
      const larger = Math.min(2 * this.atOnce, kMostAtOnce);
      if (++this.arrived >= kEnough) this.tooLarge = Infinity;
      if (larger < this.tooLarge) this.atOnce = larger;
    } catch (error) {
      if (!(error instanceof No) && body.size > kLeastAtOnce) {
        this.arrived = 0;
        this.tooLarge = body.size;
        this.atOnce = Math.max(Math.ceil(body.size / 2), kLeastAtOnce);
      }
      throw error;
    }
  }

  /** @throws  in words, for answers that are not taken; with status 409 where others were */
  async answer(answers) {
    await this.post('answers', { body: JSON.stringify(answers) }).catch(inWords);
  }
}
