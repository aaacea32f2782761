// Writes a game's log into the browser's own file system, each piece to the disk at once.
import { kFolder, markOf } from './kept_names.js';

const kFull = 'QuotaExceededError';  // some browsers throw it, others store less than they were given

let folder = null;
let handle = null;
let mark = null;
let at = 0;
let failed = null;  // why the disk took no more: nothing comes after that

function writeAll(file, bytes, from) {
  const written = file.write(bytes, { at: from });
  if (written !== bytes.length) throw new DOMException(`${written} of ${bytes.length} bytes were stored`, kFull);
  file.flush();
}

async function accessTo(name) {
  const file = await folder.getFileHandle(name, { create: true });
  return file.createSyncAccessHandle();
}

/** @return  whether the file has another game: nothing is added to it */
async function open(name) {
  const root = await navigator.storage.getDirectory();
  folder = await root.getDirectoryHandle(kFolder, { create: true });
  handle = await accessTo(name);
  const taken = handle.getSize() > 0;
  if (taken) {
    handle.close();
    return true;
  }
  mark = await accessTo(markOf(name));
  writeAll(mark, new Uint8Array(1), 0);
  return false;
}

/** This needs no room. */
function cutAtLastPiece() {
  try {
    mark.truncate(0);
    mark.flush();
  } finally {
    handle.truncate(at);
  }
}

function write(piece) {
  if (failed) throw failed;
  try {
    writeAll(handle, piece, at);
  } catch (error) {
    failed = error;
    try { cutAtLastPiece(); } catch { /* the first error is told */ }
    throw failed;
  }
  at += piece.length;
}

/** The log is whole: it needs no mark. The page asks for it before it knows what became of the last piece. */
async function close(name) {
  if (failed) throw failed;
  handle.close();
  mark.close();
  await folder.removeEntry(markOf(name)).catch(() => {});
}

self.onmessage = async ({ data: { id, kind, name, piece } }) => {
  try {
    const taken = kind === 'open' && await open(name);
    if (kind === 'write') write(piece);
    if (kind === 'close') await close(name);
    self.postMessage({ id, size: at, taken });
  } catch (error) {
    self.postMessage({ id, error: `${error.name}: ${error.message}`, full: error.name === kFull });
  }
};
