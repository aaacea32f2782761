// Writes a game's log into the browser's own file system, each piece to the disk at once.
const kFull = 'QuotaExceededError';  // some browsers throw it, others store less than they were given

let handle = null;
let at = 0;

/** @return  whether the file has another game: nothing is added to it */
async function open(name) {
  const root = await navigator.storage.getDirectory();
  const folder = await root.getDirectoryHandle('headpin', { create: true });
  const file = await folder.getFileHandle(name, { create: true });
  handle = await file.createSyncAccessHandle();
  const taken = handle.getSize() > 0;
  if (taken) handle.close();
  return taken;
}

function write(piece) {
  const written = handle.write(piece, { at });
  if (written !== piece.length) {
    handle.truncate(at);
    throw new DOMException(`${written} of ${piece.length} bytes were stored`, kFull);
  }
  at += written;
  handle.flush();
}

self.onmessage = async ({ data: { id, kind, name, piece } }) => {
  try {
    const taken = kind === 'open' && await open(name);
    if (kind === 'write') write(piece);
    if (kind === 'close') handle.close();
    self.postMessage({ id, size: at, taken });
  } catch (error) {
    self.postMessage({ id, error: `${error.name}: ${error.message}`, full: error.name === kFull });
  }
};
