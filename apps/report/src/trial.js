// A trial as the page asks for it: where everything is at a tick, and its numbers over time.

const kPose = 7;  // w, x, y, z of the turn, then the place [m]

export class Trial {
  /** @param numbers  the sections' rows, as scene/page/page_data.h says */
  constructor(json, numbers) {
    this.json = json;
    this.numbers = numbers;
    this.sections = new Map(json.sections.map((section) => [section.name, section]));
    this.poses = this.sections.get('poses');
    this.lastTick = json.ticks;
    this.ringed = { last: -1, ball: -1, each: [] };
    this.rate = json.rate_hz;
    this.looksLike = null;  // the trial whose meshes it is drawn with; null: it has its own
  }

  seconds(tick) {
    return tick / this.rate;
  }

  /** The row at or before a tick, the next one, and how far the tick is between them. */
  rowsAt(tick) {
    const { every, rows } = this.json.drawn;
    const row = tick >= this.lastTick ? rows - 1 : Math.min(Math.floor(tick / every), rows - 1);
    const next = Math.min(row + 1, rows - 1);
    const from = row * every;
    const to = Math.min(next * every, this.lastTick);
    return { row, next, share: to > from ? Math.min(1, (tick - from) / (to - from)) : 0 };
  }

  tickOfRow(row) {
    return Math.min(row * this.json.drawn.every, this.lastTick);
  }

  /** Pose of an actor, mixed between drawn ticks, into `out`: 7 numbers. */
  pose(actor, tick, out) {
    const { row, next, share } = this.rowsAt(tick);
    const width = this.poses.columns.length;
    const a = this.poses.offset + row * width + actor * kPose;
    const b = this.poses.offset + next * width + actor * kPose;
    const n = this.numbers;
    // What was put elsewhere within a row, as by a new rack, stays until the row is over.
    const jump = Math.hypot(n[b + 4] - n[a + 4], n[b + 5] - n[a + 5], n[b + 6] - n[a + 6]);
    const seconds = (this.tickOfRow(next) - this.tickOfRow(row)) / this.rate;
    const s = jump > 0.05 + 20 * seconds ? 0 : share;
    let norm = 0;
    for (let i = 0; i < kPose; ++i) {
      out[i] = n[a + i] + s * (n[b + i] - n[a + i]);
      if (i < 4) norm += out[i] * out[i];
    }
    norm = Math.sqrt(norm) || 1;
    for (let i = 0; i < 4; ++i) out[i] /= norm;
    return out;
  }

  actors(role) {
    return this.json.actors.flatMap((actor, i) => (actor.role === role ? [i] : []));
  }

  /** The mesh that an actor is seen as at a tick; -1 where it is not. */
  meshesAt(tick) {
    const { row } = this.rowsAt(tick);
    const meshes = new Array(this.json.actors.length).fill(-1);
    for (const [from, actor, mesh] of this.json.shows) {
      if (from > row) break;
      meshes[actor] = mesh;
    }
    return meshes;
  }

  /** The rows of the score board at a tick. */
  boardAt(tick) {
    const { row } = this.rowsAt(tick);
    return this.json.board.texts.findLast(([from]) => from <= row)?.[1] ?? [];
  }

  /** The rings of oil at a tick, and the actor that has them. */
  ringsAt(tick) {
    const { row } = this.rowsAt(tick);
    const { changes } = this.json.rings;
    const last = changes.findLastIndex(([from]) => from <= row);
    if (last !== this.ringed.last) {
      const each = [];
      for (const [, , kept, added] of changes.slice(0, last + 1)) each.splice(kept, Infinity, ...added);
      this.ringed = { last, ball: changes[last]?.[1] ?? -1, each };
    }
    return this.ringed;
  }

  /** All values of a column: [x of each row in seconds, value of each row]. */
  column(sectionName, column) {
    const section = this.sections.get(sectionName);
    const width = section.columns.length;
    const at = section.columns.indexOf(column);
    return Float64Array.from({ length: section.rows }, (_, row) =>
      this.numbers[section.offset + row * width + at]);
  }

  rowTimes() {
    return Float64Array.from({ length: this.json.drawn.rows }, (_, row) =>
      this.seconds(this.tickOfRow(row)));
  }

  /** Contacts of the ticks from `from` to `to`: rows begin with the tick, so they are in order. */
  *contacts(from, to) {
    const section = this.sections.get('contacts');
    const width = section.columns.length;
    const tickAt = (row) => this.numbers[section.offset + row * width];
    let low = 0;
    let high = section.rows;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (tickAt(middle) < from) low = middle + 1;
      else high = middle;
    }
    for (let row = low; row < section.rows && tickAt(row) <= to; ++row) {
      const i = section.offset + row * width;
      yield this.numbers.subarray(i, i + width);
    }
  }
}
